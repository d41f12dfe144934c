"""Rolled-out motions of the robot under its limits, many at a time."""

from math import cos, sin

import numpy as np

from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, Pose2D, Twist2D


def within_limits(aims: FloatArray, twist: Twist2D, spec: RobotSpec) -> FloatArray:
    """(T, 2, m) forward speeds and yaw rates at the end of each decision period: the speeds aimed
    at (T, 2, m), as far as the robot's speeds and accelerations allow from the present twist on."""
    period = spec.decision_period
    top = np.array([[spec.max_speed], [spec.max_yaw_rate]])
    reach = np.array([[spec.max_acceleration * period], [spec.max_yaw_acceleration * period]])
    speeds = np.clip(aims, -top, top)
    before = np.array([[twist.v], [twist.omega]])
    for speed in speeds:
        np.clip(speed, before - reach, before + reach, out=speed)
        before = speed
    return speeds


def roll_out(speeds: FloatArray, twist: Twist2D, spec: RobotSpec) -> np.ndarray:
    """(m, T, 3) float32 poses of the footprint's centre after each decision period, robot frame.

    Their transpose (3, T, m) is contiguous: one row for each period.

    Args:
        speeds: (T, 2, m) forward speed and yaw rate at each period's end, within the limits. Each
            is reached on the steepest ramp and then kept.
        twist: at the start.
        spec: the robot's parameters.
    """
    period, offset = spec.decision_period, spec.axle_offset
    reach = np.array([[spec.max_acceleration * period], [spec.max_yaw_acceleration * period]])
    start = np.broadcast_to(np.array([[twist.v], [twist.omega]]), speeds.shape[1:])
    change = np.diff(speeds, axis=0, prepend=start[None])
    mean = speeds - change * np.abs(change) / (2 * reach)
    turn = mean[:, 1] * period
    yaw = turn.cumsum(axis=0)
    middle = yaw - turn / 2
    poses = np.empty((3, *yaw.shape), dtype=np.float32)
    # The axle drives along the heading, and the centre lies ahead of it.
    poses[0] = (np.cos(middle) * mean[:, 0]).cumsum(axis=0) * period + offset * (np.cos(yaw) - 1.0)
    poses[1] = (np.sin(middle) * mean[:, 0]).cumsum(axis=0) * period + offset * np.sin(yaw)
    poses[2] = yaw
    return poses.T


def to_robot_frame(points: FloatArray, pose: Pose2D) -> FloatArray:
    """(k, 2) points of the world frame (k, 2) as seen from `pose`."""
    c, s = cos(pose.yaw), sin(pose.yaw)
    seen: FloatArray = (points - np.array([pose.x, pose.y])) @ np.array([[c, -s], [s, c]])
    return seen


def to_world_frame(points: FloatArray, pose: Pose2D) -> FloatArray:
    """(k, 2) points of the frame of `pose` (k, 2) in the world frame."""
    c, s = cos(pose.yaw), sin(pose.yaw)
    placed: FloatArray = points @ np.array([[c, s], [-s, c]]) + np.array([pose.x, pose.y])
    return placed
