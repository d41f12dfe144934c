"""What is wrong with a scenario file, as one line."""

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from pydantic import ValidationError

from fuzzynav_mj.errors import ScenarioError
from fuzzynav_mj.scenarios.file_format import SECTIONS, ScenarioFile, Table

LONGEST_VALUE = 60  # characters of a value that a message repeats

Location = Sequence[str | int]


@dataclass(frozen=True, slots=True)
class Problem:
    """One fault: the key, what it holds and what it may hold."""

    key: str
    given: str
    allowed: str


def shown(value: object) -> str:
    """Return `value` as a message shows it: in TOML's spelling, on one line, cut where long."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a table"
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # an integer of more digits than Python prints
        text = "an integer of thousands of digits"
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 3] + "..."


def scenario_error(source: str, problems: Sequence[Problem]) -> ScenarioError:
    """Return the error that names the first of `problems` and counts the others."""
    first = problems[0]
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    line = f"{source}: {first.key}: given {first.given}; allowed {first.allowed}{more}"
    return ScenarioError(" ".join(line.split()))


def problems_of(error: ValidationError) -> list[Problem]:
    """Return what `error` found, unknown keys first: a misspelt key is also a missing one."""
    unknown: list[Problem] = []
    others: list[Problem] = []
    for detail in error.errors(include_url=False, include_context=False):
        location, given = detail["loc"], shown(detail["input"])
        if detail["type"] == "extra_forbidden":
            unknown.append(_unknown_key(location))
        else:
            if detail["type"] == "missing" and isinstance(location[-1], int):
                location = location[:-1]  # a list that is too short: show the list
            elif detail["type"] == "missing":
                given = "nothing"
            problem = Problem(_dotted(location), given, _allowed(location))
            if problem not in others:
                others.append(problem)
    return unknown + others


def _dotted(location: Location) -> str:
    parts = [part if isinstance(part, int) or _is_bare(part) else repr(part) for part in location]
    return ".".join(str(part) for part in parts)


def _is_bare(key: str) -> bool:
    return key.replace("_", "").replace("-", "").isalnum()


def _table_at(location: Location) -> tuple[type[Table], str]:
    """Return the table that holds `location`, and the key within it."""
    keys = [part for part in location if isinstance(part, str)]
    section = SECTIONS.get(keys[0]) if len(keys) > 1 else None
    return (ScenarioFile, keys[0]) if section is None else (section, keys[1])


def _keys(table: type[Table]) -> dict[str, str]:
    return {
        field.alias or name: field.description or "" for name, field in table.model_fields.items()
    }


def _allowed(location: Location) -> str:
    table, key = _table_at(location)
    return _keys(table)[key]


def _unknown_key(location: Location) -> Problem:
    table, key = _table_at(location)
    allowed = list(_keys(table))
    close = get_close_matches(key, allowed, n=1)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    return Problem(_dotted(location), "an unknown key", ", ".join(allowed) + hint)
