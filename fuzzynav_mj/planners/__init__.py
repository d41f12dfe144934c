"""Planners by name."""

from collections.abc import Callable

from fuzzynav_mj.errors import UnknownNameError
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.base import Planner
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.planners.own import (
    FORM,
    is_file_name,
    planner_from_entry_point,
    planner_from_file,
    registered_planners,
)
from fuzzynav_mj.planners.peers.bug import BugPlanner
from fuzzynav_mj.planners.peers.dwa import DynamicWindowPlanner
from fuzzynav_mj.planners.peers.mppi import MppiPlanner
from fuzzynav_mj.planners.peers.orca import OrcaPlanner
from fuzzynav_mj.planners.peers.path_following import PathFollower
from fuzzynav_mj.planners.peers.prm import Prm
from fuzzynav_mj.planners.peers.rrt import Rrt
from fuzzynav_mj.planners.peers.static import StaticPlanner
from fuzzynav_mj.planners.peers.straight import StraightPlanner
from fuzzynav_mj.planners.variants import has_options, make_variant

PLANNERS: dict[str, Callable[[], Planner]] = {
    "fuzzy": lambda: MultilayerPlanner(RiskGate()),
    "multilayer": MultilayerPlanner,
    "dwa": DynamicWindowPlanner,
    "mppi": MppiPlanner,
    "orca": OrcaPlanner,
    "straight": StraightPlanner,
    "static": StaticPlanner,
    "bug": BugPlanner,
    "prm": lambda: PathFollower(Prm),
    "rrt": lambda: PathFollower(Rrt),
}


def make_planner(name: str) -> Planner:
    """A fresh planner.

    Args:
        name: of `PLANNERS`; of one that an installed package registers; one of `PLANNERS` with
            options as in `fuzzy:gate=60`; or `FILE.py:CLASS`.

    Raises:
        UnknownNameError: no planner has this name.
        FuzzyNavError: the options are not the planner's.
        PlannerError: a planner of the user's own cannot be used.
    """
    if name in PLANNERS:
        return PLANNERS[name]()
    if is_file_name(name):
        return planner_from_file(name)
    if has_options(name):
        return make_variant(name)
    registered = registered_planners()
    if name in registered:
        return planner_from_entry_point(registered[name])
    raise UnknownNameError("planner", name, planner_names(), f", or {FORM}")


def planner_names() -> tuple[str, ...]:
    """The names of the built-in and the registered planners, sorted."""
    return tuple(sorted({*PLANNERS, *registered_planners()}))
