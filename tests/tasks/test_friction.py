"""Friction between wheels and floor: it arrives in the model, and the robot slides accordingly."""

from math import hypot

import mujoco
import pytest
from scenes import scenario

from fuzzynav_mj.tasks.environment import NavigationEnvironment
from fuzzynav_mj.tasks.navigation import NavigateToGoal
from fuzzynav_mj.tasks.simulation import EpisodeSimulation

OPEN = scenario(bounds=(-9.0, -9.0, 9.0, 9.0), walls=False, goal=(8.0, 8.0))
MODELS_OWN = 1.0


def coefficients(friction: float | None) -> dict[str, float]:
    """Sliding friction by geom, and of the contacts of the parked robot by its geom."""
    environment = NavigationEnvironment(NavigateToGoal(OPEN, 0, friction=friction))
    environment.reset()
    model, data = environment.physics.model.ptr, environment.physics.data.ptr
    mujoco.mj_forward(model, data)
    found = {}
    for contact in data.contact:
        names = [model.geom(geom).name.rsplit("/", 1)[-1] for geom in contact.geom.tolist()]
        names.remove("floor")
        found[names[0]] = float(contact.friction[0])
    return found


@pytest.mark.parametrize("friction", [None, 1.0, 0.8, 0.6])
def test_the_value_arrives_in_the_wheels_contacts_and_nowhere_else(friction: float | None) -> None:
    found = coefficients(friction)
    wheels = MODELS_OWN if friction is None else friction
    assert found.pop("wheel_left") == wheels and found.pop("wheel_right") == wheels
    assert found.pop("castor") < 1e-3 and found == {}


def slide(friction: float | None) -> tuple[float, float]:
    """Way from full speed to rest, m, and the largest slip on it, m/s."""
    simulation = EpisodeSimulation(OPEN, 0, friction)
    for _ in range(15):
        simulation.drive((8.0, 0.0))
    braking_from, slip = simulation.pose.x, 0.0
    for _ in range(10):
        pose = simulation.pose
        slip = max(slip, float(simulation.drive((pose.x, pose.y)).slip.max()))
    assert hypot(simulation.twist.v, simulation.twist.omega) < 0.02
    return simulation.pose.x - braking_from, slip


def test_the_models_own_value_is_the_default_to_the_last_bit() -> None:
    assert slide(None) == slide(MODELS_OWN)


def test_braking_needs_a_coefficient_of_about_one_half_and_slides_below() -> None:
    """2 m/s2 of braking with 58 % of the weight, less while braking, on the driven wheels."""
    rest = [slide(friction) for friction in (1.0, 0.8, 0.6)]
    assert [way for way, _ in rest] == [pytest.approx(rest[0][0], rel=2e-3)] * 3
    assert max(slip for _, slip in rest) < 0.005
    ways, slips = zip(*(slide(friction) for friction in (0.4, 0.3, 0.2, 0.1)), strict=True)
    assert list(ways) == sorted(ways) and list(slips) == sorted(slips)
    assert rest[0][0] < ways[0] and 10 * rest[0][1] < slips[0]
    assert ways[-1] > 3 * rest[0][0]
