"""Runs many episodes in parallel processes, and outlives the death of any of them.

Every result is a function of its job alone, so that neither the number of processes nor the order
matters. A process that dies takes its pool with it; the episodes that were under way are then run
one at a time, where a second death has one possible cause.
"""

import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Protocol, TypeVar

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.results import EpisodeKey, FailedEpisode
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.types import EpisodeRecord

if TYPE_CHECKING:
    from fuzzynav_mj.oracle import Possibility

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")
RETRIES = 2  # runs of an episode alone, after a process died with it among others


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeJob:
    """One episode to run."""

    scenario: Scenario
    planner: str
    seed: int
    disturbance: Disturbance = PERFECT

    @property
    def key(self) -> EpisodeKey:
        """Its name."""
        return EpisodeKey(self.scenario.name, self.planner, self.seed, self.disturbance)


@dataclass(frozen=True, slots=True, eq=False)
class WorldJob:
    """One world to judge: the obstacles that a scenario has with a seed."""

    scenario: Scenario
    seed: int

    @property
    def key(self) -> EpisodeKey:
        """Its name: that of an episode without a planner."""
        return EpisodeKey(self.scenario.name, "oracle", self.seed)


class Job(Protocol):
    """What a process can be given to do."""

    @property
    def key(self) -> EpisodeKey:
        """Its name."""


Play = Callable[[EpisodeJob], EpisodeRecord | FailedEpisode]
Work = TypeVar("Work", bound=Job)
Result = TypeVar("Result")


def episode_jobs(
    scenarios: Iterable[Scenario],
    planners: Sequence[str],
    seeds: range,
    disturbance: Disturbance = PERFECT,
) -> list[EpisodeJob]:
    """Every scenario with every planner and every seed."""
    return [
        EpisodeJob(scenario, planner, seed, disturbance)
        for scenario in scenarios
        for planner in planners
        for seed in seeds
    ]


def play_job(job: EpisodeJob) -> EpisodeRecord | FailedEpisode:
    """Run one episode; whatever goes wrong in it is its failure and no other's."""
    # In the worker: the parent needs no physics.
    from fuzzynav_mj.rehearsal import settle
    from fuzzynav_mj.runner import play_episode

    try:
        settle()
        return play_episode(job.scenario, job.planner, job.seed, job.disturbance).record
    except FuzzyNavError as error:
        reason = str(error)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    return FailedEpisode(job.key, " ".join(reason.split()))


def judge_job(job: WorldJob) -> "tuple[WorldJob, Possibility] | FailedEpisode":
    """Judge one world; whatever goes wrong is its failure and no other's."""
    from fuzzynav_mj.runner import judge_world

    try:
        return job, judge_world(job.scenario, job.seed)
    except Exception as error:
        return FailedEpisode(job.key, " ".join(f"{type(error).__name__}: {error}".split()))


def run_jobs(
    jobs: Iterable[EpisodeJob], processes: int, play: Play = play_job
) -> Generator[EpisodeRecord | FailedEpisode, None, None]:
    """Run episodes as `run_parallel` does."""
    return run_parallel(jobs, processes, play)


def run_parallel(
    jobs: Iterable[Work], processes: int, work: Callable[[Work], Result | FailedEpisode]
) -> Generator[Result | FailedEpisode, None, None]:
    """Do jobs in parallel and hand each result out as it is finished.

    Closing the generator stops the processes without waiting for their jobs.

    Args:
        jobs: what to do.
        processes: how many at a time.
        work: what a worker does with a job; a function of a module, so that it can be sent.
    """
    waiting = deque(jobs)
    suspects: list[Work] = []
    while waiting:
        suspects += yield from _run_pool(waiting, processes, work)
    for job in suspects:
        for _ in range(RETRIES):
            if not (yield from _run_pool(deque([job]), 1, work)):
                break
        else:
            yield FailedEpisode(job.key, f"its process died {RETRIES + 1} times")


def _run_pool(
    waiting: deque[Work], processes: int, work: Callable[[Work], Result | FailedEpisode]
) -> Generator[Result | FailedEpisode, None, list[Work]]:
    """Run from `waiting` until it is empty or a worker dies; return what was under way then."""
    # Spawned, not forked: MuJoCo and pyarrow have threads, which a fork does not survive.
    context = get_context("spawn")
    lifeline, held = context.Pipe(duplex=False)
    workers = min(processes, len(waiting))
    pool = ProcessPoolExecutor(workers, context, _start_worker, (lifeline,))
    running: dict[Future[Result | FailedEpisode], Work] = {}
    lost: list[Work] = []
    broken = False
    try:
        while running or (waiting and not broken):
            # No more than the workers take at once: the rest is safe from their deaths.
            while waiting and not broken and len(running) < workers:
                try:
                    with _interrupts_held(), _one_thread_each():
                        future = pool.submit(work, waiting[0])
                except BrokenProcessPool:
                    broken = True
                else:
                    running[future] = waiting.popleft()
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                job = running.pop(future)
                try:
                    result = future.result()
                except BrokenProcessPool:
                    broken = True
                    lost.append(job)
                else:
                    yield result
    except BaseException:
        held.close()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        held.close()
        lifeline.close()
    return lost


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold back Ctrl-C; processes that are started meanwhile never see it.

    A terminal sends it to the workers too, which would each answer with a traceback.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes that are started meanwhile do linear algebra in one thread, or as the user says.

    The episodes are parallel already: more threads than processors cost a tenth of the time.
    NumPy reads these variables when it is imported, which a spawned process does anew.
    """
    added = [name for name in THREADS if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]


def _start_worker(lifeline: Connection) -> None:
    threading.Thread(target=_exit_at_end_of, args=(lifeline,), daemon=True).start()


def _exit_at_end_of(lifeline: Connection) -> None:
    """End this process when the parent lets go of the other end, or dies."""
    with suppress(EOFError, OSError):
        lifeline.recv()  # nothing is ever sent
    os._exit(1)
