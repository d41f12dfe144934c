"""The random streams of an episode."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Streams:
    """Independent random streams of one episode, all from one seed."""

    scenario: np.random.Generator
    sensor: np.random.Generator
    planner: np.random.Generator


def episode_streams(seed: int) -> Streams:
    """The streams of the episode with this seed."""
    children = np.random.SeedSequence(seed).spawn(3)
    return Streams(*(np.random.default_rng(child) for child in children))
