"""Arguments that several commands take, and the numbers that they allow."""

import argparse
import os
from collections.abc import Callable
from math import degrees, nan, radians
from typing import Any

from fuzzynav_mj.disturbance import (
    LARGEST,
    LARGEST_FRICTION,
    PERFECT,
    SMALLEST_FRICTION,
    Disturbance,
)
from fuzzynav_mj.errors import FuzzyNavError

LARGEST_SEED = 2**63 - 1  # the seeds are a column of 64-bit integers
LARGEST_COUNT = 1_000_000
LARGEST_JOBS = 1024

PLANNER = "as `fuzzynav list planners` names it, or FILE.py:CLASS"


class UsageError(FuzzyNavError):
    """Arguments that the command line does not take."""


def add_scenarios(parser: argparse.ArgumentParser) -> None:
    """Adds the scenarios to run, none or more."""
    parser.add_argument(
        "scenarios",
        metavar="SCENARIO",
        nargs="*",
        help="names of the library or files; the paper's four by default",
    )


def add_planners(parser: argparse.ArgumentParser, default: str) -> None:
    """Adds `--planner`, one or more; `default` says in words which ones no name stands for."""
    parser.add_argument(
        "--planner",
        metavar="NAME",
        nargs="+",
        action="extend",
        help=f"{PLANNER}; default: {default}",
    )


def add_seed(parser: argparse.ArgumentParser) -> None:
    """Adds `--seed` of a single episode."""
    parser.add_argument(
        "--seed", metavar="N", type=whole(0, LARGEST_SEED), default=0, help="default: 0"
    )


def add_episodes(parser: argparse.ArgumentParser, episodes: int, seed: int) -> None:
    """Adds `--episodes` and `--seed` with these defaults."""
    parser.add_argument(
        "--episodes",
        metavar="N",
        type=whole(1, LARGEST_COUNT),
        default=episodes,
        help=f"for every scenario and planner; default: {episodes}",
    )
    parser.add_argument(
        "--seed",
        metavar="FIRST",
        type=whole(0, LARGEST_SEED),
        default=seed,
        help=f"seed of the first episode, counted up from there; default: {seed}",
    )


def seeds_of(arguments: argparse.Namespace) -> range:
    """The seeds that `add_episodes` has taken.

    Raises:
        UsageError: they go beyond the largest one.
    """
    if arguments.seed + arguments.episodes - 1 > LARGEST_SEED:
        raise UsageError(
            f"argument --seed: given {arguments.seed} with {arguments.episodes} episodes; "
            f"allowed is a last seed of at most {LARGEST_SEED}"
        )
    return range(arguments.seed, arguments.seed + arguments.episodes)


def add_jobs(parser: argparse.ArgumentParser) -> None:
    """Adds `--jobs`."""
    parser.add_argument(
        "--jobs",
        metavar="N",
        type=whole(1, LARGEST_JOBS),
        default=min(os.cpu_count() or 1, LARGEST_JOBS),
        help="episodes at a time; default: one for every processor",
    )


def add_disturbance(parser: argparse.ArgumentParser) -> None:
    """Adds what makes sensors and floor imperfect."""
    group = parser.add_argument_group(
        "imperfect sensors and floor", "drawn anew for every seed; perfect by default"
    )
    group.add_argument(
        "--range-noise",
        metavar="M",
        type=number(0.0, LARGEST["range_noise_m"]),
        default=PERFECT.range_noise_m,
        help="standard deviation of every range reading, m",
    )
    group.add_argument(
        "--dropouts",
        metavar="FRACTION",
        type=number(0.0, LARGEST["dropouts"]),
        default=PERFECT.dropouts,
        help="share of the rays that report no hit",
    )
    group.add_argument(
        "--delay",
        metavar="PERIODS",
        type=whole(0, 1),
        default=PERFECT.delay_periods,
        help="decision periods by which the scan is late, 0 or 1",
    )
    group.add_argument(
        "--odometry-drift",
        metavar=("FRACTION", "DEG"),
        nargs=2,
        action=_Drift,
        default=(PERFECT.drift_distance, PERFECT.drift_turn_rad),
        help="error of the robot's idea of where it is: share of the way travelled, and degrees "
        "for every whole turn",
    )
    group.add_argument(
        "--friction",
        metavar="MU",
        type=number(SMALLEST_FRICTION, LARGEST_FRICTION),
        default=PERFECT.friction,
        help=f"between wheels and floor; default: {PERFECT.friction:g}",
    )


class _Drift(argparse.Action):
    """Takes the two numbers of `--odometry-drift`."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        limits = LARGEST["drift_distance"], round(degrees(LARGEST["drift_turn_rad"]), 6)
        for text, limit in zip(values, limits, strict=True):
            if not 0.0 <= _float(text) <= limit:
                raise argparse.ArgumentError(
                    self,
                    f"given {text!r}; allowed is FRACTION from 0 to {limits[0]:g} and DEG from 0 "
                    f"to {limits[1]:g}",
                )
        setattr(namespace, self.dest, (float(values[0]), radians(float(values[1]))))


def disturbance_of(arguments: argparse.Namespace) -> Disturbance:
    """What `add_disturbance` has taken."""
    drift_distance, drift_turn = arguments.odometry_drift
    return Disturbance(
        range_noise_m=arguments.range_noise,
        dropouts=arguments.dropouts,
        delay_periods=arguments.delay,
        drift_distance=drift_distance,
        drift_turn_rad=drift_turn,
        friction=arguments.friction,
    )


def whole(least: int, most: int) -> Callable[[str], int]:
    """A converter to whole numbers from `least` to `most`, in plain digits."""

    def convert(text: str) -> int:
        plain = text.isascii() and text.isdigit() and len(text) <= len(str(most))
        if not plain or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(
                f"given {text!r}; allowed is a whole number from {least} to {most}"
            )
        return int(text)

    return convert


def number(least: float, most: float) -> Callable[[str], float]:
    """A converter to numbers from `least` to `most`."""

    def convert(text: str) -> float:
        value = _float(text)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(
                f"given {text!r}; allowed is a number from {least:g} to {most:g}"
            )
        return value

    return convert


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return nan
