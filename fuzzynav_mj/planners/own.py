"""Planners of the user's own: a class in a Python file, or one that another package registers.

A planner is made by calling its class without arguments. It is held to what `Planner` promises:
what it lacks, raises or returns wrongly is one `PlannerError` that names the planner and the place.
"""

import sys
import traceback
from hashlib import sha256
from importlib.metadata import EntryPoint, entry_points
from importlib.util import module_from_spec, spec_from_file_location
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from fuzzynav_mj.errors import PlannerError
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Planner, Requirements
from fuzzynav_mj.types import Decision

GROUP = "fuzzynav_mj.planners"
FORM = "FILE.py:CLASS"


class OwnPlanner:
    """A planner of the user's own, its mistakes turned into clear errors.

    Attributes:
        requires: what the planner declares.
    """

    def __init__(self, name: str, planner: Any, file: str) -> None:
        self._name = name
        self._planner = planner
        self._file = file
        self.requires: Requirements = planner.requires

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode.

        Raises:
            PlannerError: the planner raised something.
        """
        try:
            self._planner.reset(problem, rng)
        except Exception as error:
            raise PlannerError(f"{self._name}: reset: {_told(error, self._file)}") from error

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why.

        Raises:
            PlannerError: the planner raised something, or gave no usable decision.
        """
        try:
            decision = self._planner.decide(observation)
        except Exception as error:
            raise PlannerError(f"{self._name}: decide: {_told(error, self._file)}") from error
        if not isinstance(decision, Decision):
            raise PlannerError(
                f"{self._name}: decide: given {_described(decision)}; allowed is a "
                "fuzzynav_mj.types.Decision"
            )
        if not _is_point(decision.next_position):
            raise PlannerError(
                f"{self._name}: decide: next_position: given {decision.next_position!r}; "
                "allowed are two finite numbers x, y in m"
            )
        return decision


def is_file_name(name: str) -> bool:
    """True if `name` speaks of a planner in a file."""
    path, colon, _ = name.rpartition(":")
    return name.endswith(".py") or (bool(colon) and path.endswith(".py"))


def planner_from_file(name: str) -> Planner:
    """A fresh planner of the class that `name`, `FILE.py:CLASS`, speaks of.

    The file is run anew each time, so that nothing lasts from one episode to the next.

    Raises:
        PlannerError: there is no such file or class, the file fails, or the class is no planner.
    """
    path, _, class_name = name.rpartition(":")
    if not path.endswith(".py"):
        raise PlannerError(f"{name}: --planner: given a file without a class; allowed is {FORM}")
    module = _run_file(path)
    kind = getattr(module, class_name, None) if class_name else None
    if not isinstance(kind, type):
        own = [
            n for n, v in vars(module).items()
            if isinstance(v, type) and v.__module__ == module.__name__
        ]  # fmt: skip
        raise PlannerError(
            f"{path}: --planner: given class {class_name!r}; allowed is a class of this file: "
            f"{', '.join(own) or 'it has none'}"
        )
    return _made(name, kind, path)


def registered_planners() -> dict[str, EntryPoint]:
    """The planners that installed packages register in the entry point group `GROUP`, by name."""
    return {point.name: point for point in entry_points(group=GROUP)}


def planner_from_entry_point(point: EntryPoint) -> Planner:
    """A fresh planner of a registered class.

    Raises:
        PlannerError: it cannot be imported, or is no planner.
    """
    try:
        kind = point.load()
    except Exception as error:
        raise PlannerError(
            f"{point.name}: entry point {point.value!r} cannot be imported: {_told(error, '')}"
        ) from error
    file = getattr(sys.modules.get(getattr(kind, "__module__", "")), "__file__", None)
    return _made(point.name, kind, file or "")


def file_digest(name: str) -> str | None:
    """SHA-256 of the file of a planner in a file; None for other planners.

    Raises:
        PlannerError: it cannot be read.
    """
    return sha256(_content(name.rpartition(":")[0])).hexdigest() if is_file_name(name) else None


def _run_file(path: str) -> Any:
    content = _content(path)
    module_name = f"fuzzynav_own_{sha256(str(Path(path).absolute()).encode()).hexdigest()[:16]}"
    spec = spec_from_file_location(module_name, path)
    assert spec is not None
    module = module_from_spec(spec)
    sys.modules[module_name] = module  # dataclasses look their module up there
    try:
        exec(compile(content, path, "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        raise PlannerError(f"{path}: cannot be imported: {_told(error, path)}") from error
    return module


def _content(path: str) -> bytes:
    try:
        return Path(path).read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise PlannerError(
            f"{path}: --planner: given a file that cannot be read ({reason}); allowed is {FORM}"
        ) from None


def _made(name: str, kind: Any, file: str) -> Planner:
    lacking = [n for n in ("requires", "reset", "decide") if not hasattr(kind, n)]
    if lacking:
        raise PlannerError(
            f"{name}: given {_described(kind)} without {', '.join(lacking)}; "
            "allowed is a class with requires, reset and decide"
        )
    if not isinstance(kind.requires, Requirements):
        raise PlannerError(
            f"{name}: requires: given {_described(kind.requires)}; "
            "allowed is a fuzzynav_mj.planners.base.Requirements"
        )
    try:
        planner = kind()
    except Exception as error:
        raise PlannerError(
            f"{name}: cannot be made without arguments: {_told(error, file)}"
        ) from error
    return OwnPlanner(name, planner, file)


def _told(error: BaseException, file: str) -> str:
    """Where in `file` the error arose, its kind, and its first line."""
    places = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == file]
    line = places[-1].lineno if places else None
    text = str(error).strip().partition("\n")[0]
    if isinstance(error, SyntaxError):
        line, text = error.lineno, error.msg
    place = f"line {line}: " if line is not None else ""
    return f"{place}{type(error).__name__}: {text}".removesuffix(": ")


def _described(value: Any) -> str:
    if isinstance(value, type):
        return f"a class {value.__name__}"
    return "None" if value is None else f"a value of type {type(value).__name__}"


def _is_point(value: Any) -> bool:
    try:
        x, y = value
        return isfinite(x) and isfinite(y)
    except (TypeError, ValueError):
        return False
