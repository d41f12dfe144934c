"""Imperfect sensors: their errors have the stated size, and nothing else changes."""

from math import cos, hypot, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.sensing.disturbed import Sensors, from_frame, in_frame, perfect_sensors
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.types import LaserScan, Pose2D

RAYS, REACH = 180, 0.8
ORIGIN = Pose2D(0.0, 0.0, 0.0)


def scan(stamp: float = 0.0, distance: float = 0.4) -> LaserScan:
    """Every second ray hits something at `distance`."""
    hit = np.arange(RAYS) % 2 == 0
    ranges = np.where(hit, distance, REACH)
    return LaserScan(stamp, ray_bearings(RAYS), ranges, hit, REACH)


def sensors(seed: int = 1, **wrong: float) -> Sensors:
    """Sensors with these settings."""
    return Sensors(Disturbance(**wrong), np.random.default_rng(seed))  # type: ignore[arg-type]


def scans(made: Sensors, count: int, distance: float = 0.4) -> list[LaserScan]:
    """What these sensors tell of `count` equal scans."""
    told = [made.look(ORIGIN, scan(0.1 * k, distance)).scan for k in range(count)]
    return [one for one in told if one is not None]


# Nothing wrong --------------------------------------------------------------------------------


@pytest.mark.parametrize("made", [perfect_sensors(), sensors(), sensors(friction=0.6)])
def test_without_disturbance_the_truth_is_passed_on_as_it_is(made: Sensors) -> None:
    for k in range(3):
        truth, taken = Pose2D(0.1 * k, 0.2, 0.3 * k), scan(0.1 * k)
        look = made.look(truth, taken)
        assert look.scan is taken and look.estimate is truth and look.scan_estimate is truth
        assert made.target(truth, look, (0.3, 0.4)) == (0.3, 0.4)


def test_a_robot_that_does_not_look_is_told_no_scan() -> None:
    made = sensors(range_noise_m=0.01, dropouts=0.05, delay_periods=1)
    assert [made.look(ORIGIN, None).scan for _ in range(3)] == [None] * 3


# Noise and dropouts ----------------------------------------------------------------------------


@pytest.mark.parametrize("sigma", [0.005, 0.01, 0.02])
def test_noise_has_the_stated_deviation_and_no_bias(sigma: float) -> None:
    told = scans(sensors(range_noise_m=sigma), 200)
    errors = np.concatenate([one.ranges[::2] - 0.4 for one in told])
    count = len(errors)  # 18,000: four standard errors are 2.1 % of sigma
    assert abs(errors.std() / sigma - 1.0) < 4.0 / np.sqrt(2 * count)
    assert abs(errors.mean()) < 4.0 * sigma / np.sqrt(count)
    neighbours = np.corrcoef(errors[:-1], errors[1:])[0, 1]
    assert abs(neighbours) < 4.0 / np.sqrt(count)


def test_noise_leaves_rays_without_a_hit_alone() -> None:
    for one in scans(sensors(range_noise_m=0.02), 20):
        assert (one.ranges[1::2] == REACH).all() and not one.hit[1::2].any()
        assert one.hit[::2].all()


def test_noise_beyond_the_sensors_range_is_no_hit_and_none_is_negative() -> None:
    """At the very range half of the readings lie beyond it; at zero half would be negative."""
    far = scans(sensors(range_noise_m=0.02), 100, REACH - 1e-9)
    share = np.mean([one.hit[::2].mean() for one in far])
    assert abs(share - 0.5) < 4.0 * 0.5 / np.sqrt(9000)
    assert all(((one.ranges < REACH) == one.hit).all() for one in far)
    near = scans(sensors(range_noise_m=0.02), 100, 0.0)
    assert all((one.ranges >= 0.0).all() and one.hit[::2].all() for one in near)


@pytest.mark.parametrize("share", [0.02, 0.05])
def test_dropouts_have_the_stated_rate(share: float) -> None:
    told = scans(sensors(dropouts=share), 200)
    lost = np.concatenate([~one.hit[::2] for one in told])
    assert abs(lost.mean() - share) < 4.0 * np.sqrt(share * (1 - share) / len(lost))
    for one in told:
        assert (one.ranges == np.where(one.hit, 0.4, REACH)).all()


def test_the_true_scan_is_not_written_to() -> None:
    taken = scan()
    before = taken.ranges.tobytes(), taken.hit.tobytes()
    sensors(range_noise_m=0.02, dropouts=0.05).look(ORIGIN, taken)
    assert (taken.ranges.tobytes(), taken.hit.tobytes()) == before


def test_same_seed_same_bits_and_other_seeds_other_bits() -> None:
    wrong = {"range_noise_m": 0.01, "dropouts": 0.02}
    first, again, other = (
        np.array([one.ranges for one in scans(sensors(seed, **wrong), 5)]) for seed in (3, 3, 4)
    )
    assert first.tobytes() == again.tobytes() and first.tobytes() != other.tobytes()


def test_one_disturbance_does_not_change_what_another_draws() -> None:
    """Rays that are not lost carry the same noise with dropouts as without; the drift likewise."""
    alone = scans(sensors(range_noise_m=0.01), 5)
    both = scans(sensors(range_noise_m=0.01, dropouts=0.05), 5)
    for one, other in zip(alone, both, strict=True):
        assert (one.ranges[other.hit] == other.ranges[other.hit]).all()
    drift = {"drift_distance": 0.01, "drift_turn_rad": 0.02}
    ways = [straight(sensors(**drift, **more), 2.0) for more in ({}, {"range_noise_m": 0.01})]
    assert ways[0] == ways[1]


# Delay -----------------------------------------------------------------------------------------


def test_a_delayed_scan_is_the_one_before_with_the_pose_of_then() -> None:
    made = sensors(delay_periods=1)
    taken = [scan(0.1 * k) for k in range(4)]
    poses = [Pose2D(0.05 * k, 0.0, 0.1 * k) for k in range(4)]
    looks = [made.look(pose, one) for pose, one in zip(poses, taken, strict=True)]
    assert [look.scan for look in looks] == [taken[0], taken[0], taken[1], taken[2]]
    assert [look.estimate for look in looks] == poses
    assert [look.scan_estimate for look in looks] == [poses[0], poses[0], poses[1], poses[2]]


def test_delay_and_noise_give_the_noisy_scan_of_the_period_before() -> None:
    prompt = scans(sensors(range_noise_m=0.01), 4)
    late = scans(sensors(range_noise_m=0.01, delay_periods=1), 4)
    assert [one.stamp for one in late] == [0.0, 0.0, 0.1, 0.2]
    for one, other in zip(prompt[:-1], late[1:], strict=True):
        assert one.ranges.tobytes() == other.ranges.tobytes()


# Drift -----------------------------------------------------------------------------------------


def straight(made: Sensors, length: float, step: float = 0.05) -> tuple[float, float]:
    """Estimated place after `length` metres along x."""
    for k in range(round(length / step) + 1):
        look = made.look(Pose2D(step * k, 0.0, 0.0), None)
    return look.estimate.x, look.estimate.y


def test_drift_after_ten_metres_straight_is_one_percent_give_or_take() -> None:
    """A systematic 0.1 m either way, and sqrt(10) * 0.01 m = 0.0316 m (one sigma) at random."""
    off = np.array([straight(sensors(seed, drift_distance=0.01), 10.0) for seed in range(200)])
    assert (off[:, 1] == 0.0).all()  # no turn, no error of the heading
    errors = off[:, 0] - 10.0
    assert 0.35 < (errors > 0.0).mean() < 0.65
    sizes = np.abs(errors)
    assert sizes.mean() == pytest.approx(0.1, abs=4 * 0.0316 / np.sqrt(200))
    assert sizes.std() == pytest.approx(0.0316, rel=4 / np.sqrt(400))


def test_heading_after_one_turn_is_off_by_the_stated_angle_give_or_take() -> None:
    """A systematic 1 degree either way, and one degree (one sigma) at random."""
    errors = []
    for seed in range(200):
        made = sensors(seed, drift_turn_rad=radians(1.0))
        for k in range(64 + 1):
            yaw = (2 * pi * k / 64 + pi) % (2 * pi) - pi
            look = made.look(Pose2D(0.0, 0.0, yaw), None)
        errors.append((look.estimate.yaw + pi) % (2 * pi) - pi)
        assert (look.estimate.x, look.estimate.y) == (0.0, 0.0)
    spread = np.degrees(np.sqrt(np.mean(np.square(errors))))
    assert spread == pytest.approx(2**0.5, rel=4 / np.sqrt(400))
    assert abs(np.degrees(np.mean(errors))) < 4 * 2**0.5 / np.sqrt(200)


def test_drift_does_not_depend_on_how_the_way_is_cut_into_periods() -> None:
    """Variances add up: the random part after 4 m is the same for steps of 5 cm and of 1 cm."""
    spreads = []
    for step in (0.05, 0.01):
        ends = [straight(sensors(s, drift_distance=0.01), 4.0, step)[0] - 4.0 for s in range(100)]
        spreads.append(np.std(np.abs(ends)))
    assert spreads == [pytest.approx(0.02, rel=4 / np.sqrt(200))] * 2


def test_a_parked_robot_does_not_drift() -> None:
    made = sensors(drift_distance=0.1, drift_turn_rad=radians(10.0))
    place = Pose2D(1.0, 2.0, 0.5)
    looks = [made.look(place, None) for _ in range(50)]
    assert {(look.estimate.x, look.estimate.y, look.estimate.yaw) for look in looks} == {
        (1.0, 2.0, 0.5)
    }


POSES = st.builds(Pose2D, *[st.floats(-20, 20)] * 2, st.floats(-pi, pi))


@given(POSES, st.floats(-20, 20), st.floats(-20, 20))
@settings(max_examples=50)
def test_frames_invert_each_other_and_keep_distances(frame: Pose2D, x: float, y: float) -> None:
    forward, left = in_frame(frame, x, y)
    assert from_frame(frame, forward, left) == (
        pytest.approx(x, abs=1e-9),
        pytest.approx(y, abs=1e-9),
    )
    assert hypot(forward, left) == pytest.approx(hypot(x - frame.x, y - frame.y), abs=1e-9)


def test_the_wheels_go_from_the_truth_as_the_robot_would_from_its_estimate() -> None:
    """One step ahead of the estimate is one step ahead of the true pose, in its own direction."""
    made = sensors(2, drift_distance=0.05, drift_turn_rad=radians(10.0))
    for k in range(60):
        truth = Pose2D(cos(0.1 * k), sin(0.1 * k), 0.1 * k)
        look = made.look(truth, None)
    here = look.estimate
    assert hypot(here.x - truth.x, here.y - truth.y) > 0.01 and here.yaw != truth.yaw
    ahead = (here.x + 0.05 * cos(here.yaw), here.y + 0.05 * sin(here.yaw))
    x, y = made.target(truth, look, ahead)
    assert x == pytest.approx(truth.x + 0.05 * cos(truth.yaw), abs=1e-12)
    assert y == pytest.approx(truth.y + 0.05 * sin(truth.yaw), abs=1e-12)


# Settings --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"range_noise_m": 0.2}, "range_noise_m: given 0.2; allowed is a number from 0 to 0.1"),
        ({"dropouts": -0.1}, "dropouts: given -0.1; allowed is a number from 0 to 0.5"),
        ({"delay_periods": 2}, "delay_periods: given 2; allowed is 0 or 1"),
        ({"drift_distance": 1.0}, "drift_distance: given 1.0; allowed is a number from 0 to 0.1"),
        (
            {"drift_turn_rad": 1.0},
            "drift_turn_rad: given 1.0; allowed is a number from 0 to 0.1745",
        ),
        ({"friction": 0.0}, "friction: given 0.0; allowed is a number from 0.1 to 1"),
        ({"friction": float("nan")}, "friction: given nan; allowed is a number from 0.1 to 1"),
    ],
)
def test_values_out_of_range_are_named(wrong: dict[str, float], message: str) -> None:
    with pytest.raises(FuzzyNavError) as caught:
        Disturbance(**wrong)  # type: ignore[arg-type]
    assert str(caught.value) == message


def test_in_few_words() -> None:
    assert str(PERFECT) == "none"
    everything = Disturbance(0.01, 0.02, 1, 0.01, radians(1.0), 0.6)
    assert str(everything) == (
        "noise 0.01 m, dropouts 2 %, delay 1, drift 1 %, 1 deg, friction 0.6"
    )
