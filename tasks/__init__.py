"""dm_control tasks: the only part that imports dm_control."""

import os

# dm_control looks for a display at its first import; nothing is rendered unless the user asks.
os.environ.setdefault("MUJOCO_GL", "disable")

from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.tasks.environment import NavigationEnvironment
from fuzzynav_mj.tasks.navigation import NavigateToGoal


def load(name: str, seed: int = 0) -> NavigationEnvironment:
    """A dm_env environment for a library scenario or a scenario file.

    Args:
        name: library name, or path of a `.toml` file.
        seed: of the first episode; every further reset plays the next seed.

    Raises:
        FuzzyNavError: unknown name or unusable file.
    """
    return NavigationEnvironment(NavigateToGoal(load_scenario(name), seed))
