"""The rehearsal takes the same functions and tables as an episode does."""

import gc
import sys

from numba.core.registry import CPUDispatcher

from fuzzynav_mj.disturbance import Disturbance
from fuzzynav_mj.planners.grid import grid_around
from fuzzynav_mj.rehearsal import SELDOM, rehearse, settle
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario


def specialisations() -> dict[str, int]:
    """How often each compiled function has been made or loaded, by its name."""
    return {
        f"{name}.{function.__name__}": len(function.signatures)
        for name, module in list(sys.modules.items())
        if name.startswith("fuzzynav_mj.")
        for function in vars(module).values()
        if isinstance(function, CPUDispatcher)
    }


def test_nothing_is_left_to_be_compiled_or_filled_in_an_episode() -> None:
    rehearse()
    before, grids = specialisations(), grid_around.cache_info().misses
    assert before
    for name in ("trap", "narrow", "concave", "maze", "faster"):
        play_episode(load_scenario(name), "fuzzy", 1)
    noisy = Disturbance(range_noise_m=0.01, dropouts=0.02, delay_periods=1)
    play_episode(load_scenario("convex"), "fuzzy", 1, noisy)
    assert specialisations() == before
    assert grid_around.cache_info().misses == grids


def test_what_start_up_made_is_not_searched_for_garbage() -> None:
    before = gc.get_threshold()
    settle.cache_clear()
    settle()
    made = gc.get_freeze_count()
    assert made > 100_000
    assert len(gc.get_objects()) < made / 100
    assert gc.get_threshold()[0] == SELDOM
    gc.unfreeze()
    gc.set_threshold(*before)
