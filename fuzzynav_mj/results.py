"""The folder that a benchmark leaves behind: a log that grows by the episode, and a table."""

import contextlib
import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from fuzzynav_mj.disturbance import FIELDS, PERFECT, Disturbance
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.metrics import record_to_row
from fuzzynav_mj.oracle import Possibility
from fuzzynav_mj.types import EpisodeRecord

LOG = "episodes.jsonl"
TABLE = "episodes.parquet"
SUMMARY = "summary.md"
SCENARIOS = "scenarios"

TEXT_COLUMNS = (
    "scenario", "planner", "outcome", "contact_with", "scenario_sha256", "planner_sha256",
    "possible",
)  # fmt: skip
WHOLE_COLUMNS = (
    "seed", "contacts_count", "gate_vetoes", "decisions", "physics_steps", "delay_periods",
)  # fmt: skip
FLAG_COLUMNS = ("contact_at_fault",)
COLUMNS = (
    "scenario", "planner", "seed", "outcome", "sim_time_s", "path_length_m", "shortest_path_m",
    "optimality", "min_clearance_m", "risk_max", "risk_mean", "gate_vetoes", "decisions",
    "plan_ms_p50", "plan_ms_p99", "wall_s", "physics_steps", "tracking_rms_m", "slip_max_mps",
    "contacts_count", "contact_time_s", "contact_with", "contact_robot_speed_mps",
    "contact_at_fault", "goal_distance_m", "range_noise_m", "dropouts", "delay_periods",
    "drift_distance", "drift_turn_rad", "friction", "version_fuzzynav_mj", "version_mujoco",
    "version_dm_control", "version_numpy", "scenario_sha256", "planner_sha256", "possible",
    "earliest_arrival_s",
)  # fmt: skip
"""The columns of the table, in order: the fields of the episode record, flattened; the digests of
the scenario's file and of the planner's, where it is a file of the user's own; and what the oracle
says of the world, empty where it was not asked."""

POSSIBLE, IMPOSSIBLE, UNKNOWN = "yes", "no", "unknown"

Row = dict[str, Any]


@dataclass(frozen=True, slots=True, order=True)
class EpisodeKey:
    """What tells one episode of a benchmark from another."""

    scenario: str
    planner: str
    seed: int
    disturbance: Disturbance = PERFECT

    def __str__(self) -> str:
        text = f"{self.scenario}, {self.planner}, seed {self.seed}"
        return text if self.disturbance == PERFECT else f"{text}, {self.disturbance}"


@dataclass(frozen=True, slots=True)
class FailedEpisode:
    """An episode that came to no end of its own.

    Attributes:
        key: which one.
        reason: what stopped it, one line.
    """

    key: EpisodeKey
    reason: str


def key_of(result: EpisodeRecord | FailedEpisode) -> EpisodeKey:
    """Which episode a result is of."""
    if isinstance(result, FailedEpisode):
        return result.key
    return EpisodeKey(result.scenario, result.planner, result.seed, result.disturbance)


def key_of_row(row: Row) -> EpisodeKey:
    """Which episode a row is of.

    Raises:
        KeyError, TypeError, ValueError, FuzzyNavError: it does not say.
    """
    return EpisodeKey(
        str(row["scenario"]), str(row["planner"]), int(row["seed"]), disturbance_of(row)
    )


def row_order(key: EpisodeKey) -> tuple[str, str, Disturbance, int]:
    """Sorts episodes as the rows are: what belongs together stays so."""
    return key.scenario, key.planner, key.disturbance, key.seed


def disturbance_of(row: Row) -> Disturbance:
    """What a row says of the sensors and the floor; perfect ones where it says nothing.

    Raises:
        FuzzyNavError: its values are not allowed.
        TypeError: they are not numbers.
    """
    return Disturbance(**{name: row[name] for name in FIELDS if name in row})


def possibility_columns(found: Possibility) -> Row:
    """What the oracle says of a world, as columns of its episodes.

    `possible` is "yes" where a contact-free run was found with every clearance kept, "no" where
    not even the optimistic search finds one, and "unknown" between the two.
    """
    verdict = UNKNOWN if found.possible_optimistic else IMPOSSIBLE
    arrival = found.earliest_arrival_s
    return {
        "possible": POSSIBLE if found.possible_cautious else verdict,
        "earliest_arrival_s": arrival if math.isfinite(arrival) else None,
    }


class EpisodeLog:
    """Finished episodes, one JSON object a line, each on disk before the next one is taken.

    A line counts once its newline is there, so a process that dies while writing costs one episode.
    Of several lines for one episode the last one counts.

    Args:
        folder: holds the log and what is made of it; made where it is missing.
        resume: whether the folder may hold episodes already.

    Attributes:
        rows: by key, in the order of being finished.
        failures: reason by key, of the episodes that failed and were not finished since.

    Raises:
        FuzzyNavError: the folder holds results and `resume` is false, it cannot be written, or its
            log is not one.
    """

    def __init__(self, folder: Path, resume: bool) -> None:
        self.folder = folder
        self.rows: dict[EpisodeKey, Row] = {}
        self.failures: dict[EpisodeKey, str] = {}
        path = folder / LOG
        try:
            folder.mkdir(parents=True, exist_ok=True)
            content = path.read_bytes() if path.exists() else b""
            if not resume and (content or (folder / TABLE).exists()):
                raise FuzzyNavError(
                    f"{folder}: --out: given a folder that holds results; "
                    "allowed is one without, or --resume to add what is missing"
                )
            whole = content.rfind(b"\n") + 1
            for number, line in enumerate(content[:whole].splitlines(), start=1):
                self._keep(*parse_line(line, path, number))
            self._file = path.open("ab")
            self._file.truncate(whole)
        except OSError as error:
            raise FuzzyNavError(
                f"{folder}: --out: given a folder that cannot be used ({error.strerror}); "
                "allowed is one that can be written"
            ) from None

    def add(
        self,
        result: EpisodeRecord | FailedEpisode,
        scenario_sha256: str,
        planner_sha256: str | None = None,
    ) -> None:
        """Write one episode to disk, and wait until it is there.

        Args:
            result: the episode.
            scenario_sha256: digest of its scenario's file.
            planner_sha256: digest of its planner's file, where it is one of the user's own.

        Raises:
            FuzzyNavError: it cannot be written.
        """
        key = key_of(result)
        if isinstance(result, FailedEpisode):
            row: Row = {"scenario": key.scenario, "planner": key.planner, "seed": key.seed}
            row |= asdict(key.disturbance) | {"error": result.reason}
        else:
            digests = {"scenario_sha256": scenario_sha256, "planner_sha256": planner_sha256}
            row = record_to_row(result) | digests
        self._write([(key, row)])

    def complete(self, columns: Mapping[EpisodeKey, Row]) -> None:
        """Add columns to finished episodes, and wait until they are on disk.

        Raises:
            FuzzyNavError: they cannot be written.
        """
        self._write([(key, self.rows[key] | added) for key, added in columns.items()])

    def _write(self, rows: Sequence[tuple[EpisodeKey, Row]]) -> None:
        lines = "".join(json.dumps(row, allow_nan=False) + "\n" for _, row in rows)
        try:
            self._file.write(lines.encode())
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            path = self.folder / LOG
            raise FuzzyNavError(f"{path}: cannot write an episode: {error.strerror}") from None
        for key, row in rows:
            self._keep(key, row)

    def sorted_rows(self) -> list[Row]:
        """The finished episodes by scenario, planner, disturbance and seed."""
        keys = sorted(self.rows, key=row_order)
        return [self.rows[key] for key in keys]

    def close(self) -> None:
        """Close the file; nothing can be added afterwards."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _keep(self, key: EpisodeKey, row: Row) -> None:
        if "error" in row:
            self.failures[key] = row["error"]
        else:
            self.rows[key] = row
            self.failures.pop(key, None)


def parse_line(line: bytes, path: Path, number: int) -> tuple[EpisodeKey, Row]:
    """The episode on a line of a log; `path` and `number` are where it stands.

    Raises:
        FuzzyNavError: the line is not an episode.
    """
    try:
        row = json.loads(line)
        key = key_of_row(row)
    except (ValueError, KeyError, TypeError, FuzzyNavError):
        raise FuzzyNavError(
            f"{path}: line {number}: given text that is not an episode; "
            "allowed is one JSON object with scenario, planner and seed"
        ) from None
    return key, row


def write_table(rows: Sequence[Row], path: Path) -> None:
    """Write `rows` as a Parquet file with the columns `COLUMNS`, whole or not at all.

    Raises:
        FuzzyNavError: it cannot be written.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    def type_of(column: str) -> pa.DataType:
        if column in TEXT_COLUMNS or column.startswith("version_"):
            return pa.string()
        if column in WHOLE_COLUMNS:
            return pa.int64()
        return pa.bool_() if column in FLAG_COLUMNS else pa.float64()

    schema = pa.schema([(column, type_of(column)) for column in COLUMNS])
    table = pa.Table.from_pylist(list(rows), schema=schema)
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    replace_file(path, sink.getvalue().to_pybytes())


def keep_scenario(folder: Path, name: str, content: bytes) -> None:
    """Keep the file of a scenario beside its episodes, under its name and digest.

    Raises:
        FuzzyNavError: it cannot be written.
    """
    kept = folder / SCENARIOS
    try:
        kept.mkdir(exist_ok=True)
    except OSError as error:
        raise FuzzyNavError(f"{kept}: cannot be made: {error.strerror}") from None
    file = kept / f"{slug(name)}-{sha256(content).hexdigest()[:12]}.toml"
    if not file.exists():
        replace_file(file, content)


def slug(name: str) -> str:
    """A name as a part of a file's name."""
    return "".join(c if c.isascii() and c.isalnum() else "_" for c in name)[:60]


def replace_file(path: Path, content: bytes) -> None:
    """Write a file whole or not at all.

    Raises:
        FuzzyNavError: it cannot be written.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_bytes(content)
        part.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink()
        raise FuzzyNavError(f"{path}: cannot be written: {error.strerror}") from None
