"""What a benchmark has left in its folder, read without changing it."""

from dataclasses import dataclass
from pathlib import Path

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.results import LOG, TABLE, EpisodeKey, Row, key_of_row, parse_line, row_order

NEEDED = ("scenario", "planner", "seed", "outcome", "path_length_m")


@dataclass(frozen=True, slots=True, eq=False)
class BenchFolder:
    """The episodes of a benchmark.

    Attributes:
        path: the folder.
        rows: the finished episodes, sorted by scenario, planner, disturbance and seed.
        failures: reason by episode, of those that came to no end of their own.
    """

    path: Path
    rows: tuple[Row, ...]
    failures: dict[EpisodeKey, str]

    @property
    def scenarios(self) -> tuple[str, ...]:
        """Names of the scenarios."""
        return tuple(dict.fromkeys(row["scenario"] for row in self.rows))

    @property
    def planners(self) -> tuple[str, ...]:
        """Names of the planners."""
        return tuple(sorted({row["planner"] for row in self.rows}))


def read_folder(path: Path) -> BenchFolder:
    """Read the log of a benchmark, or its table where there is no log.

    Raises:
        FuzzyNavError: the folder holds neither, or what it holds are no episodes.
    """
    log, table = path / LOG, path / TABLE
    rows: dict[EpisodeKey, Row] = {}
    failures: dict[EpisodeKey, str] = {}
    try:
        if log.is_file():
            content = log.read_bytes()
            lines = content[: content.rfind(b"\n") + 1].splitlines()
            episodes = [parse_line(line, log, n) for n, line in enumerate(lines, start=1)]
        elif table.is_file():
            episodes = _table_rows(table)
        else:
            raise FuzzyNavError(
                f"{path}: given a folder without {LOG} and {TABLE}; "
                "allowed is one that fuzzynav bench has written"
            )
    except OSError as error:
        raise FuzzyNavError(
            f"{path}: given a folder that cannot be read ({error.strerror or error})"
            "; allowed is one that fuzzynav bench has written"
        ) from None
    for key, row in episodes:
        if "error" in row:
            failures[key] = str(row["error"])
            continue
        missing = [name for name in NEEDED if name not in row]
        if missing:
            raise FuzzyNavError(f"{path}: {key}: given an episode without {', '.join(missing)}")
        rows[key] = row
        failures.pop(key, None)
    if not rows:
        raise FuzzyNavError(
            f"{path}: given a folder without a finished episode; allowed is one with at least one"
        )
    return BenchFolder(path, tuple(rows[key] for key in sorted(rows, key=row_order)), failures)


def _table_rows(path: Path) -> list[tuple[EpisodeKey, Row]]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        rows = pq.read_table(path).to_pylist()
        return [(key_of_row(row), row) for row in rows]
    except (pa.ArrowException, KeyError, TypeError, ValueError, FuzzyNavError):
        raise FuzzyNavError(
            f"{path}: given a file that is no table of episodes; "
            "allowed is one that fuzzynav bench has written"
        ) from None
