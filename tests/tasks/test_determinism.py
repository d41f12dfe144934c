"""Same seed, same episode, to the last bit; and which reset plays which seed."""

import numpy as np
from scenes import scenario

from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.tasks import load
from fuzzynav_mj.tasks.environment import NavigationEnvironment
from fuzzynav_mj.tasks.navigation import NavigateToGoal
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.tasks.streams import episode_streams
from fuzzynav_mj.types import FloatArray

STEPS = 40


def wander(made: Scenario, seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Poses, mover positions and ranges of an episode driven by fixed random steps."""
    simulation = EpisodeSimulation(made, seed)
    rng = np.random.default_rng(99)
    poses, movers, ranges = [], [], []
    for _ in range(STEPS):
        x, y = rng.uniform(-0.03, 0.06, 2)
        block = simulation.drive((simulation.pose.x + x, simulation.pose.y + y))
        poses.append(block.poses)
        movers.append(block.movers)
        ranges.append(simulation.scan.ranges)
    return np.concatenate(poses), np.concatenate(movers), np.array(ranges)


def test_same_seed_twice_is_bit_identical() -> None:
    made = load_scenario("convex")
    first = wander(made, 5)
    wander(load_scenario("maze"), 1)  # another episode in between leaves no trace
    for one, other in zip(first, wander(made, 5), strict=True):
        assert np.array_equal(one, other)


def test_seeds_differ() -> None:
    made = load_scenario("convex")
    assert not np.array_equal(wander(made, 5)[1][0], wander(made, 6)[1][0])


def played(environment: NavigationEnvironment) -> list[FloatArray]:
    """Every observation of the environment's next episode, driven by fixed actions."""
    rng = np.random.default_rng(7)
    timestep = environment.reset()
    rows = [np.concatenate(list(timestep.observation.values()))]
    for _ in range(STEPS):
        x, y, _ = timestep.observation["pose"]
        timestep = environment.step(np.array([x, y]) + rng.uniform(-0.03, 0.06, 2))
        rows.append(np.concatenate(list(timestep.observation.values())))
        if timestep.last():
            break
    return rows


def test_kth_reset_plays_the_kth_seed() -> None:
    environment = load("convex", seed=20)
    for k in range(3):
        again = played(environment)
        assert environment.task.seed == 20 + k
        fresh = load("convex", seed=20 + k)
        assert np.array_equal(again, played(fresh))
        movers = zip(environment.task.world.movers, fresh.task.world.movers, strict=True)
        times = np.array([0.0, 3.0])
        for one, other in movers:
            assert np.array_equal(one.motion.positions(times), other.motion.positions(times))


def test_worlds_without_drawn_movers_repeat_too() -> None:
    """Their model is compiled once; what a reset leaves behind would show."""
    environment = NavigationEnvironment(NavigateToGoal(scenario(), 3))
    first, second = played(environment), played(environment)
    assert np.array_equal(first, second)
    assert environment.task.seed == 4
    numbers = environment.task.streams.planner.random(4)
    assert np.array_equal(numbers, episode_streams(4).planner.random(4))


def test_streams_are_independent() -> None:
    """A planner's draws change neither its world nor the sensor."""
    one, other = episode_streams(8), episode_streams(8)
    one.planner.random(1000)
    assert np.array_equal(one.scenario.random(5), other.scenario.random(5))
    assert np.array_equal(one.sensor.random(5), other.sensor.random(5))
    firsts = {float(stream.random()) for stream in (one.scenario, one.sensor, one.planner)}
    assert len(firsts) == 3


def test_episodes_and_agents_are_driven_alike_to_the_last_bit() -> None:
    """Episodes skip the environment's own step, which only adds what agents are told."""
    simulation = EpisodeSimulation(load_scenario("convex"), 5)
    environment = load("convex", seed=5)
    timestep = environment.reset()
    rng = np.random.default_rng(99)
    for _ in range(STEPS):
        pose = simulation.pose
        assert timestep.observation["pose"].tolist() == [pose.x, pose.y, pose.yaw]
        assert np.array_equal(timestep.observation["ranges"], simulation.scan.ranges)
        x, y = rng.uniform(-0.03, 0.06, 2)
        simulation.drive((pose.x + x, pose.y + y))
        timestep = environment.step(np.array([pose.x + x, pose.y + y]))
