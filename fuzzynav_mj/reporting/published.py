"""What the paper reports: its Tables 2 and 3, as printed.

F. Kamil and M. Y. Moghrabiah 2022, doi 10.1080/16168658.2021.2019432. The paper states neither the
scale of its environments nor what its run times measure, so its lengths and times compare with
nobody's in size, only its failures and its order of planners do.
"""

from collections.abc import Mapping
from dataclasses import dataclass

EPISODES = 100
"""Runs of each planner in each environment, section 5."""

OPTIMALITY_PERCENT = 89.0
"""Mean optimality of the fuzzy planner over the four environments, from the abstract."""

RISK_LIMIT = 76.0
"""Largest accepted risk, section 5."""


@dataclass(frozen=True, slots=True)
class Published:
    """One planner in one environment.

    Attributes:
        run_time: mean, s; of what, the paper does not say.
        path: mean length; the paper states no unit.
        failures: percent.
        run_time_std: of Table 2; None in Table 3, which has none.
        path_std: likewise.
    """

    run_time: float
    path: float
    failures: float
    run_time_std: float | None = None
    path_std: float | None = None


TABLE_2: Mapping[str, Published] = {
    "concave": Published(4.44, 13.14, 0.0, 0.33, 0.60),
    "convex": Published(4.36, 13.20, 0.0, 0.35, 0.57),
    "maze": Published(8.95, 16.96, 0.0, 0.20, 0.49),
    "narrow": Published(3.50, 9.14, 0.0, 0.13, 0.23),
}
"""The fuzzy planner, by world."""

TABLE_3: Mapping[str, Mapping[str, Published]] = {
    "prm": {
        "concave": Published(10.81, 14.20, 13.0),
        "convex": Published(5.95, 13.61, 14.0),
        "maze": Published(23.94, 17.85, 27.0),
        "narrow": Published(6.91, 10.15, 64.0),
    },
    "rrt": {
        "concave": Published(19.43, 15.82, 9.0),
        "convex": Published(12.95, 5.71, 13.0),  # 5.71 is printed so; see `ODDITIES`
        "maze": Published(27.28, 18.0, 21.0),
        "narrow": Published(11.35, 10.6, 42.0),
    },
    "dwa": {
        "concave": Published(14.25, 16.87, 65.0),
        "convex": Published(20.0, 15.0, 9.0),
        "maze": Published(20.5, 18.2, 55.0),
        "narrow": Published(13.01, 14.20, 70.0),
    },
    "bug": {
        "concave": Published(30.0, 16.21, 0.0),
        "convex": Published(14.69, 31.0, 0.0),
        "maze": Published(28.52, 20.0, 0.0),
        "narrow": Published(20.11, 14.10, 0.0),
    },
    "multilayer": {
        "concave": Published(3.14, 13.64, 0.0),
        "convex": Published(2.17, 13.21, 0.0),
        "maze": Published(7.35, 17.67, 0.0),
        "narrow": Published(2.04, 9.19, 0.0),
    },
    "fuzzy": {
        "concave": Published(4.44, 13.14, 0.0),
        "convex": Published(4.36, 13.20, 0.0),
        "maze": Published(8.95, 16.96, 0.0),
        "narrow": Published(3.50, 9.14, 0.0),
    },
}
"""By planner, under our names, and world."""

ODDITIES = (
    "The paper prints 5.71 as RRT's path in convex, less than half of every other planner's "
    "there, and 14.69 s with a path of 31 for Bug, which may be interchanged; both are shown as "
    "printed."
)


def published(planner: str, scenario: str) -> Published | None:
    """What Table 3 says of a planner in a world; None where it says nothing."""
    return TABLE_3.get(planner, {}).get(scenario)
