"""Rows as a benchmark writes them, made by hand."""

import json
from pathlib import Path
from typing import Any

from fuzzynav_mj.results import LOG, Row

SHORTEST = 10.0


def row(
    scenario: str = "concave",
    planner: str = "fuzzy",
    seed: int = 0,
    outcome: str = "goal_reached",
    path: float = 12.5,
    **more: Any,
) -> Row:
    """An episode; what is not given is as in an uneventful one."""
    reached = outcome == "goal_reached"
    return {
        "scenario": scenario,
        "planner": planner,
        "seed": seed,
        "outcome": outcome,
        "sim_time_s": 30.0,
        "path_length_m": path,
        "shortest_path_m": SHORTEST,
        "optimality": SHORTEST / path if reached else None,
        "gate_vetoes": 0,
        "plan_ms_p50": 2.0,
        "plan_ms_p99": 4.0,
        "wall_s": 1.0,
        "scenario_sha256": "0",
        "version_numpy": "2.0",
        **more,
    }


def write_log(folder: Path, *rows: Row) -> Path:
    """Write the rows as the log of a benchmark; returns the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / LOG).write_text("".join(json.dumps(line) + "\n" for line in rows))
    return folder
