"""The command line: arguments in, exit status out.

Nothing heavy is imported here, so that `--help` and mistakes are answered at once.
"""

import argparse
import io
import os
import sys
from collections.abc import Callable, Sequence
from math import degrees, nan, radians
from pathlib import Path
from typing import Any, NoReturn

from fuzzynav_mj import __version__
from fuzzynav_mj.disturbance import (
    LARGEST,
    LARGEST_FRICTION,
    PERFECT,
    SMALLEST_FRICTION,
    Disturbance,
)
from fuzzynav_mj.errors import FuzzyNavError

BAD_INPUT = 2
INTERRUPTED = 130  # as shells say that a process ended by Ctrl-C
BROKEN_PIPE = 141

LARGEST_SEED = 2**63 - 1  # the seeds are a column of 64-bit integers
LARGEST_COUNT = 1_000_000
LARGEST_JOBS = 1024

PLANNER_HELP = "as `fuzzynav list planners` names it, or FILE.py:CLASS; default: fuzzy"
EXIT_STATUS = (
    "exit status: 0 the goal was reached without contact (run), every episode was run (bench, "
    "reproduce), every file is good (check); 1 otherwise; 2 bad input"
)


class UsageError(FuzzyNavError):
    """Arguments that the command line does not take."""


class _Parser(argparse.ArgumentParser):
    def __init__(self, **settings: Any) -> None:
        super().__init__(allow_abbrev=False, **settings)

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message} (see {self.prog} --help)")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        argv: the arguments; those of the process by default.

    Returns:
        The exit status.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # whatever the terminal can show
    try:
        try:
            return _dispatch(argv)
        finally:
            sys.stdout.flush()
    except FuzzyNavError as error:
        print("fuzzynav:", " ".join(str(error).split()), file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("fuzzynav: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has gone. Python would complain when it flushes once more at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE


def _dispatch(argv: Sequence[str] | None) -> int:
    try:
        arguments = _parser().parse_args(argv)
    except SystemExit as end:  # --help and --version
        return int(end.code or 0)
    status: int = arguments.command(arguments)
    return status


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="fuzzynav",
        description="Mapless fuzzy navigation among moving obstacles, simulated in MuJoCo.",
        epilog=EXIT_STATUS,
    )
    parser.add_argument("--version", action="version", version=f"fuzzynav {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _add_run(commands.add_parser("run", help="simulate one episode", epilog=EXIT_STATUS))
    _add_bench(commands.add_parser("bench", help="run many episodes", epilog=EXIT_STATUS))
    _add_report(commands.add_parser("report", help="make a page of what bench has written"))
    _add_reproduce(
        commands.add_parser(
            "reproduce", help="run and report the paper's comparison", epilog=EXIT_STATUS
        )
    )
    _add_list(commands.add_parser("list", help="list the scenarios or the planners"))
    _add_speed(commands.add_parser("speed", help="measure what an episode costs, by stages"))
    _add_check(commands.add_parser("check", help="check scenario files", epilog=EXIT_STATUS))
    return parser


def _add_run(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scenario", metavar="SCENARIO", help="a name of the library or a file")
    parser.add_argument("--planner", metavar="NAME", default="fuzzy", help=PLANNER_HELP)
    parser.add_argument(
        "--seed", metavar="N", type=_whole(0, LARGEST_SEED), default=0, help="default: 0"
    )
    parser.add_argument("--rrd", metavar="FILE", type=Path, help="write a Rerun recording")
    parser.add_argument("--json", action="store_true", help="print the record as one JSON object")
    parser.add_argument("--quiet", action="store_true", help="print no summary")
    _add_disturbance(parser)
    parser.set_defaults(command=_run)


def _run(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.run import run

    return run(
        scenario=arguments.scenario,
        planner=arguments.planner,
        seed=arguments.seed,
        recording=arguments.rrd,
        as_json=arguments.json,
        quiet=arguments.quiet,
        disturbance=_disturbance(arguments),
    )


def _add_bench(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scenarios",
        metavar="SCENARIO",
        nargs="*",
        help="names of the library or files; the paper's four by default",
    )
    parser.add_argument("--planner", metavar="NAME", nargs="+", action="extend", help=PLANNER_HELP)
    _add_episodes(parser, episodes=10, seed=0)
    _add_jobs(parser)
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        default=Path("results"),
        help="folder for the results; default: results",
    )
    parser.add_argument(
        "--resume", action="store_true", help="keep what DIR holds and run what is missing"
    )
    parser.add_argument(
        "--oracle",
        action="store_true",
        help="judge whether each world leaves a contact-free run; with --resume also of what DIR "
        "holds",
    )
    _add_disturbance(parser)
    parser.set_defaults(command=_bench)


def _bench(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.bench import bench

    return bench(
        names=arguments.scenarios,
        planners=arguments.planner or ["fuzzy"],
        seeds=_seeds(arguments),
        processes=arguments.jobs,
        folder=arguments.out,
        resume=arguments.resume,
        oracle=arguments.oracle,
        disturbance=_disturbance(arguments),
    )


def _add_disturbance(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "imperfect sensors and floor", "drawn anew for every seed; perfect by default"
    )
    group.add_argument(
        "--range-noise",
        metavar="M",
        type=_number(0.0, LARGEST["range_noise_m"]),
        default=PERFECT.range_noise_m,
        help="standard deviation of every range reading, m",
    )
    group.add_argument(
        "--dropouts",
        metavar="FRACTION",
        type=_number(0.0, LARGEST["dropouts"]),
        default=PERFECT.dropouts,
        help="share of the rays that report no hit",
    )
    group.add_argument(
        "--delay",
        metavar="PERIODS",
        type=_whole(0, 1),
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
        type=_number(SMALLEST_FRICTION, LARGEST_FRICTION),
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


def _disturbance(arguments: argparse.Namespace) -> Disturbance:
    drift_distance, drift_turn = arguments.odometry_drift
    return Disturbance(
        range_noise_m=arguments.range_noise,
        dropouts=arguments.dropouts,
        delay_periods=arguments.delay,
        drift_distance=drift_distance,
        drift_turn_rad=drift_turn,
        friction=arguments.friction,
    )


def _add_report(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", metavar="DIR", type=Path, help="the folder of a benchmark")
    parser.add_argument(
        "--out", metavar="DIR", type=Path, help="folder for the report; default: DIR/report"
    )
    _add_jobs(parser)
    parser.set_defaults(command=_report)


def _report(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.report import report

    return report(arguments.folder, arguments.out, arguments.jobs)


def _add_reproduce(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--planner",
        metavar="NAME",
        nargs="+",
        action="extend",
        help="as `fuzzynav list planners` names it, or FILE.py:CLASS; default: every built-in one",
    )
    _add_episodes(parser, episodes=100, seed=1000)
    _add_jobs(parser)
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        default=Path("reproduction"),
        help="folder for the results, from which a run that was ended goes on; "
        "default: reproduction",
    )
    parser.set_defaults(command=_reproduce)


def _reproduce(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.reproduce import reproduce

    return reproduce(
        planners=arguments.planner or [],
        seeds=_seeds(arguments),
        processes=arguments.jobs,
        folder=arguments.out,
    )


def _add_episodes(parser: argparse.ArgumentParser, episodes: int, seed: int) -> None:
    parser.add_argument(
        "--episodes",
        metavar="N",
        type=_whole(1, LARGEST_COUNT),
        default=episodes,
        help=f"for every scenario and planner; default: {episodes}",
    )
    parser.add_argument(
        "--seed",
        metavar="FIRST",
        type=_whole(0, LARGEST_SEED),
        default=seed,
        help=f"seed of the first episode, counted up from there; default: {seed}",
    )


def _seeds(arguments: argparse.Namespace) -> range:
    if arguments.seed + arguments.episodes - 1 > LARGEST_SEED:
        raise UsageError(
            f"argument --seed: given {arguments.seed} with {arguments.episodes} episodes; "
            f"allowed is a last seed of at most {LARGEST_SEED}"
        )
    return range(arguments.seed, arguments.seed + arguments.episodes)


def _add_jobs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--jobs",
        metavar="N",
        type=_whole(1, LARGEST_JOBS),
        default=min(os.cpu_count() or 1, LARGEST_JOBS),
        help="episodes at a time; default: one for every processor",
    )


def _add_list(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "what", metavar="scenarios|planners", choices=("scenarios", "planners"), help="which"
    )
    parser.set_defaults(command=_list)


def _list(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.listing import list_planners, list_scenarios

    return list_scenarios() if arguments.what == "scenarios" else list_planners()


def _add_speed(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scenarios",
        metavar="SCENARIO",
        nargs="*",
        help="names of the library or files; the paper's four by default",
    )
    parser.add_argument(
        "--seed", metavar="N", type=_whole(0, LARGEST_SEED), default=0, help="default: 0"
    )
    parser.add_argument(
        "--repeats",
        metavar="N",
        type=_whole(1, 100),
        default=3,
        help="medians are of so many; default: 3",
    )
    parser.add_argument(
        "--cpu", action="store_true", help="count processor time: steadier on a busy machine"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object, times in s")
    parser.set_defaults(command=_speed)


def _speed(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.speed import speed

    return speed(
        names=arguments.scenarios,
        seed=arguments.seed,
        repeats=arguments.repeats,
        cpu=arguments.cpu,
        as_json=arguments.json,
    )


def _add_check(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", metavar="FILE", nargs="+", help="a scenario file")
    parser.set_defaults(command=_check)


def _check(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.listing import check_files

    return check_files(arguments.files)


def _whole(least: int, most: int) -> Callable[[str], int]:
    """A converter to whole numbers from `least` to `most`, in plain digits."""

    def convert(text: str) -> int:
        plain = text.isascii() and text.isdigit() and len(text) <= len(str(most))
        if not plain or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(
                f"given {text!r}; allowed is a whole number from {least} to {most}"
            )
        return int(text)

    return convert


def _number(least: float, most: float) -> Callable[[str], float]:
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


if __name__ == "__main__":
    sys.exit(main())
