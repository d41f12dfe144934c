"""Which ways guidance has to choose from: straight ones, searched ones, and beside walls."""

from math import pi

from fuzzynav_mj.planners.boundary import Following, Point
from fuzzynav_mj.planners.openings import promises, unreached_rays
from fuzzynav_mj.planners.search import searched_ways
from fuzzynav_mj.planners.settings import GuidanceSettings
from fuzzynav_mj.planners.sight import Sight, Ways, either, straight_ways
from fuzzynav_mj.planners.walls import Walls, led_along
from fuzzynav_mj.types import FloatArray


def straight_ways_in(sight: Sight, settings: GuidanceSettings) -> Ways:
    """Comfortable straight ways, and tight ones where they save enough."""
    return straight_ways(sight, settings.comfortable, settings.tight, settings.tight_penalty)


def ways_in_sight(
    place: Point,
    goal: FloatArray,
    sight: Sight,
    following: Following | None,
    settings: GuidanceSettings,
) -> Ways:
    """Straight ways, and searched ones where they might help.

    Args:
        place: of the robot, world frame, m.
        goal: (2,) from there, m.
        sight: what stands.
        following: the boundary that is followed, if one is.
        settings: widths and gains.
    """
    ways = straight_ways_in(sight, settings)
    if _search_might_help(place, goal, sight, ways, following, settings):
        found = searched_ways(sight, settings.tight, settings.comfortable)
        ways = either(ways, found, settings.tight_penalty)
    return ways


def way_beside_walls(
    chosen: int,
    goal: FloatArray,
    sight: Sight,
    ways: Ways,
    walls: Walls,
    settings: GuidanceSettings,
) -> int:
    """Ray of the way to take for the straight one chosen, in view of walls that run on."""
    straight = ways.open & ~ways.searched
    if not straight[chosen]:
        return chosen
    return led_along(
        chosen, sight.bearings, straight, ways.end[chosen], goal, walls,
        settings.onward, settings.comfortable,
    )  # fmt: skip


def _search_might_help(
    place: Point,
    goal: FloatArray,
    sight: Sight,
    ways: Ways,
    following: Following | None,
    settings: GuidanceSettings,
) -> bool:
    """True if a ray sees free ground that no straight way reaches, and it would be wanted."""
    if following is None:
        promised, have = promises(
            sight.ranges, sight.bearings, sight.max_range, settings.tight,
            ways.open, ways.length, ways.end, goal,
        )  # fmt: skip
        return promised < have - settings.search_gain
    lead = unreached_rays(
        following.beside(place, sight), following.side,
        sight.ranges, sight.max_range, settings.tight, ways.open,
    )  # fmt: skip
    # The width of the robot hides a few rays beside every edge; those promise nothing.
    hidden = settings.tight / sight.max_range * len(sight.ranges) / (2 * pi)
    return lead > 1.5 * hidden
