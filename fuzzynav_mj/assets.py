"""Finds the MJCF files, in a checkout and in an installed wheel alike."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import as_file, files
from pathlib import Path


@contextmanager
def model_path(name: str) -> Iterator[Path]:
    """Path of a file below `models/`, for example "robots/diff_drive.xml", while in use."""
    with as_file(files("fuzzynav_mj") / "models") as folder:
        yield folder / name
