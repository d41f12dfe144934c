"""Planners by name."""

from collections.abc import Callable

from fuzzynav_mj.errors import UnknownNameError
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.base import Planner
from fuzzynav_mj.planners.multilayer import MultilayerPlanner

PLANNERS: dict[str, Callable[[], Planner]] = {
    "fuzzy": lambda: MultilayerPlanner(RiskGate()),
    "multilayer": MultilayerPlanner,
}


def make_planner(name: str) -> Planner:
    """A fresh planner.

    Raises:
        UnknownNameError: no planner has this name.
    """
    if name not in PLANNERS:
        raise UnknownNameError("planner", name, PLANNERS)
    return PLANNERS[name]()
