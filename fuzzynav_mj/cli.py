"""The command line: arguments in, exit status out.

Nothing heavy is imported here, so that `--help` and mistakes are answered at once.
"""

import argparse
import io
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from fuzzynav_mj import __version__
from fuzzynav_mj.arguments import (
    PLANNER,
    UsageError,
    add_disturbance,
    add_episodes,
    add_jobs,
    add_planners,
    add_scenarios,
    add_seed,
    disturbance_of,
    seeds_of,
    whole,
)
from fuzzynav_mj.errors import FuzzyNavError

BAD_INPUT = 2
INTERRUPTED = 130  # as shells say that a process ended by Ctrl-C
BROKEN_PIPE = 141

EXIT_STATUS = (
    "exit status: 0 the goal was reached without contact (run), every episode was run (bench, "
    "reproduce), every file is good (check); 1 otherwise; 2 bad input"
)


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
    parser.add_argument(
        "--planner", metavar="NAME", default="fuzzy", help=f"{PLANNER}; default: fuzzy"
    )
    add_seed(parser)
    parser.add_argument("--rrd", metavar="FILE", type=Path, help="write a Rerun recording")
    parser.add_argument("--json", action="store_true", help="print the record as one JSON object")
    parser.add_argument("--quiet", action="store_true", help="print no summary")
    add_disturbance(parser)
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
        disturbance=disturbance_of(arguments),
    )


def _add_bench(parser: argparse.ArgumentParser) -> None:
    add_scenarios(parser)
    add_planners(parser, default="fuzzy")
    add_episodes(parser, episodes=10, seed=0)
    add_jobs(parser)
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
    add_disturbance(parser)
    parser.set_defaults(command=_bench)


def _bench(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.bench import bench

    return bench(
        names=arguments.scenarios,
        planners=arguments.planner or ["fuzzy"],
        seeds=seeds_of(arguments),
        processes=arguments.jobs,
        folder=arguments.out,
        resume=arguments.resume,
        oracle=arguments.oracle,
        disturbance=disturbance_of(arguments),
    )


def _add_report(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", metavar="DIR", type=Path, help="the folder of a benchmark")
    parser.add_argument(
        "--out", metavar="DIR", type=Path, help="folder for the report; default: DIR/report"
    )
    add_jobs(parser)
    parser.set_defaults(command=_report)


def _report(arguments: argparse.Namespace) -> int:
    from fuzzynav_mj.commands.report import report

    return report(arguments.folder, arguments.out, arguments.jobs)


def _add_reproduce(parser: argparse.ArgumentParser) -> None:
    add_planners(parser, default="every built-in one")
    add_episodes(parser, episodes=100, seed=1000)
    add_jobs(parser)
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
        seeds=seeds_of(arguments),
        processes=arguments.jobs,
        folder=arguments.out,
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
    add_scenarios(parser)
    add_seed(parser)
    parser.add_argument(
        "--repeats",
        metavar="N",
        type=whole(1, 100),
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


if __name__ == "__main__":
    sys.exit(main())
