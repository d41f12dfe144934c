"""What a report keeps of an episode that it plays once more."""

from collections.abc import Callable

import numpy as np
import pytest

from fuzzynav_mj.benchmark import EpisodeJob
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.reporting.traces import Trace, trace_job
from fuzzynav_mj.results import FailedEpisode
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.scenarios.schema import Scenario

OBSTACLES = """
[[static]]
circle = [0.85, 0.75, 0.05]
[[moving]]
circle = 0.1
waypoints = [[1.5, 0.3], [1.5, 0.9]]
speed = 0.3
"""
LIMIT = 40.0  # low, so that the gate refuses often


@pytest.fixture
def scenario(write_scenario: Callable[..., str]) -> Scenario:
    return load_scenario(write_scenario("small", OBSTACLES))


def traced(scenario: Scenario, planner: str) -> Trace:
    trace = trace_job(EpisodeJob(scenario, planner, 3))
    assert isinstance(trace, Trace)
    return trace


def test_a_trace_is_the_episode_that_was_benched(scenario: Scenario) -> None:
    episode = play_episode(scenario, "multilayer", 3)
    trace = traced(scenario, "multilayer")
    assert (trace.outcome, trace.path_length_m) == (
        episode.record.outcome, episode.record.path_length_m,
    )  # fmt: skip
    assert trace.poses.shape == (episode.record.decisions, 3)
    assert trace.movers.shape == (episode.record.decisions, 1, 2)
    assert trace.poses[0].tolist() == [0.5, 0.6, 0.0]
    assert trace.movers[0, 0].tolist() == [1.5, 0.3]
    assert [shape.radius for shape in trace.shapes] == [0.1]
    assert np.isnan(trace.risks).all() and trace.peak is None


def test_what_was_refused_is_above_the_limit_and_the_peak_is_explained(scenario: Scenario) -> None:
    trace = traced(scenario, f"fuzzy:gate={LIMIT:g}")
    refused = trace.proposed[~np.isnan(trace.proposed)]
    assert len(refused) > 0 and refused.min() > LIMIT
    assert trace.peak is not None
    top = np.fmax(trace.risks, trace.proposed)
    assert trace.peak.risk == top[trace.peak.step] == pytest.approx(top.max(), abs=0.1)
    assert RiskGate().risk(trace.peak.inputs) == pytest.approx(trace.peak.risk, abs=0.05)


def test_an_episode_that_cannot_be_played_is_a_failure_with_its_reason(scenario: Scenario) -> None:
    job = EpisodeJob(scenario, "gone.py:P", 3)
    failed = trace_job(job)
    assert isinstance(failed, FailedEpisode)
    assert failed.key == job.key
    assert failed.reason.startswith("gone.py: --planner: given a file that cannot be read")
