"""`fuzzynav speed`: what an episode costs, stage by stage, beside bare physics."""

import json
import time
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from fuzzynav_mj.scenarios import PAPER_SCENARIOS, load_scenario
from fuzzynav_mj.speed import (
    FEW,
    MANY,
    STAGES,
    EpisodeSpeed,
    time_crowds,
    time_episode,
    time_single_risk,
)
from fuzzynav_mj.timed import Clock


def speed(names: Sequence[str], seed: int, repeats: int, cpu: bool, as_json: bool) -> int:
    """Measure, and print what was found.

    Args:
        names: names or files of scenarios; the paper's four where empty.
        seed: of the episodes.
        repeats: how often each measurement is made; medians are told.
        cpu: count the processor's time instead of the wall's: steadier on a busy machine.
        as_json: print one JSON object, times in s, and nothing else.

    Returns:
        The exit status, 0.

    Raises:
        FuzzyNavError: bad input.
    """
    clock: Clock = time.thread_time if cpu else time.perf_counter
    scenarios = [load_scenario(name) for name in dict.fromkeys(names or PAPER_SCENARIOS)]
    episodes = [time_episode(scenario, seed, repeats, clock) for scenario in scenarios]
    few, many = time_crowds(repeats, clock)
    found: dict[str, Any] = {
        "clock": "cpu" if cpu else "wall",
        "repeats": repeats,
        "seed": seed,
        "episodes": [
            asdict(episode) | {"real_time_factor": episode.real_time_factor} for episode in episodes
        ],
        "single_risk": time_single_risk(repeats, clock),
        "crowd_few": few,
        "crowd_many": many,
        "crowd_ratio": many / few,
    }
    if as_json:
        print(json.dumps(found, allow_nan=False))
    else:
        print("\n".join(lines(episodes, found)))
    return 0


def lines(episodes: Sequence[EpisodeSpeed], found: dict[str, Any]) -> list[str]:
    """The findings as text: ms for each decision period, a column for every scenario."""
    rows: list[tuple[str, list[str]]] = [("", [episode.scenario for episode in episodes])]
    for stage in STAGES:
        rows.append((stage, [f"{_period_ms(e, e.stages[stage]):.3f}" for e in episodes]))
    rows += [
        ("whole episode", [f"{_period_ms(e, e.total):.3f}" for e in episodes]),
        ("bare mj_step", [f"{_period_ms(e, e.bare):.3f}" for e in episodes]),
        ("ratio of the two", [f"{e.ratio:.1f}" for e in episodes]),
        ("real-time factor", [f"{e.real_time_factor:.0f}" for e in episodes]),
        ("decision, median", [f"{1e3 * e.decision_p50:.3f}" for e in episodes]),
        ("decision, 99th pct.", [f"{1e3 * e.decision_p99:.3f}" for e in episodes]),
        ("first decision", [f"{1e3 * e.first_decision:.3f}" for e in episodes]),
        ("decisions", [f"{e.decisions}" for e in episodes]),
    ]
    clock = {"cpu": "processor time", "wall": "wall time"}[found["clock"]]
    return [
        f"ms of {clock} for each decision period, median of {found['repeats']}; "
        f"seed {found['seed']}, planner fuzzy",
        *(f"{label:<20}" + "".join(f"{cell:>12}" for cell in cells) for label, cells in rows),
        f"one fuzzy risk: {1e6 * found['single_risk']:.1f} us",
        f"a decision among {MANY} static obstacles: {1e3 * found['crowd_many']:.3f} ms, "
        f"{found['crowd_ratio']:.2f} times one among {FEW}",
    ]


def _period_ms(episode: EpisodeSpeed, seconds: float) -> float:
    return 1e3 * seconds / max(episode.decisions, 1)
