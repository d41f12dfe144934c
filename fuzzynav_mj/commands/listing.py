"""`fuzzynav list` and `fuzzynav check`: what there is, and whether a file can be used."""

import sys
from collections.abc import Sequence

import numpy as np

from fuzzynav_mj.errors import FuzzyNavError, PlannerError
from fuzzynav_mj.planners import make_planner, planner_names
from fuzzynav_mj.planners.base import given_to
from fuzzynav_mj.planners.own import FORM
from fuzzynav_mj.planners.variants import OPTIONS
from fuzzynav_mj.scenarios import PAPER_SCENARIOS, library_names, load_scenario
from fuzzynav_mj.scenarios.world import make_world


def list_scenarios() -> int:
    """Print the library's scenarios, one a line, the paper's four first: name and description."""
    names = PAPER_SCENARIOS + tuple(n for n in library_names() if n not in PAPER_SCENARIOS)
    width = max(map(len, names))
    for name in names:
        print(f"{name:<{width}}  {load_scenario(name).description}")
    return 0


def list_planners() -> int:
    """Print the planners, one a line: name and what each is given; then what else is taken."""
    lines = {}
    for name in planner_names():
        try:
            lines[name] = f"given {'; '.join(given_to(make_planner(name).requires))}"
        except PlannerError as error:
            lines[name] = f"cannot be used: {error}"
    for name, options in OPTIONS.items():
        allowed = "; ".join(f"{option}={values}" for option, values in options.items())
        lines[f"{name}:OPTION=VALUE,..."] = f"with {allowed}"
    lines[FORM] = "a planner of your own: a class in a Python file"
    width = max(map(len, lines))
    for name, about in lines.items():
        print(f"{name:<{width}}  {about}")
    return 0


def check_files(files: Sequence[str]) -> int:
    """Print a line for every scenario file: to standard error what is wrong with it."""
    status = 0
    for file in files:
        try:
            scenario = load_scenario(file)
            # Only drawing shows whether the drawn obstacles find room.
            make_world(scenario, np.random.default_rng(0))
        except FuzzyNavError as error:
            print(f"fuzzynav: {error}", file=sys.stderr)
            status = 2
        else:
            print(f"{file}: ok ({scenario.name})")
    return status
