"""How commands that run many episodes tell what they are at."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic


@contextmanager
def progress_bar(what: str, total: int) -> Iterator[Callable[[], None]]:
    """A progress bar on standard error where that is a terminal; call the result per episode."""
    if total == 0 or not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    with Progress(
        TextColumn(what),
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
    ) as progress:
        task = progress.add_task(what, total=total, rate="")
        began = monotonic()

        def advance() -> None:
            progress.advance(task)
            done = progress.tasks[0].completed
            progress.update(task, rate=f"{60 * done / (monotonic() - began):.0f} per min")

        yield advance


def note(text: str) -> None:
    """Tell the user something beside the results."""
    print(f"fuzzynav: {text}", file=sys.stderr)
