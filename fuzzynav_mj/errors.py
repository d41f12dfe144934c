"""The errors a user can cause, each one clear line."""

from collections.abc import Iterable
from difflib import get_close_matches


class FuzzyNavError(Exception):
    """Base of every error that bad input causes; the command line prints it and exits with 2."""


class ScenarioError(FuzzyNavError):
    """An unusable scenario file: names the file, the key, the value and what is allowed."""


class PlannerError(FuzzyNavError):
    """A planner of the user's own that cannot be used: names it, what is wrong and where."""


class UnknownNameError(FuzzyNavError):
    """A name that is not in a registry: lists the allowed names, and what `also` is allowed."""

    def __init__(self, kind: str, given: str, allowed: Iterable[str], also: str = "") -> None:
        names = sorted(allowed)
        close = get_close_matches(given, names, n=1)
        hint = f" Did you mean {close[0]!r}?" if close else ""
        super().__init__(f"unknown {kind} {given!r}: allowed are {', '.join(names)}{also}.{hint}")
