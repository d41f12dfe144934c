"""A composer environment that takes all physics steps of a decision period in one block."""

import numpy as np
from dm_control import composer

from fuzzynav_mj.tasks.navigation import NavigateToGoal


class NavigationEnvironment(composer.Environment):
    """A dm_env environment around `NavigateToGoal`.

    The action is the next position (x, y) of the footprint's centre in the world frame, due one
    decision period later. Each `reset` starts the next episode: the k-th one plays seed + k.
    """

    def __init__(self, task: NavigateToGoal) -> None:
        super().__init__(
            task,
            time_limit=task.scenario.time_limit,
            random_state=np.random.RandomState(0),  # unused: the task draws from its own seed
            strip_singleton_obs_buffer_dim=True,
            recompile_mjcf_every_episode=task.redraws,
        )

    def _substep(self, action: np.ndarray) -> None:
        # Composer's own loop splits every physics step in two and runs its hooks around each;
        # the task's block takes plain steps instead, at about half the cost.
        self._task.advance()
