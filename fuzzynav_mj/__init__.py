"""Mapless fuzzy navigation of a wheeled robot among moving obstacles, in MuJoCo."""

from pathlib import Path

__version__ = "0.1.0"

for _part in ("tasks", "models"):
    if not (Path(__file__).parent / _part).is_dir():
        raise ImportError(
            f"fuzzynav_mj/{_part} must be a link to ../{_part}: this checkout was made without "
            "symbolic links. Run `git config core.symlinks true && git checkout -- fuzzynav_mj`."
        )
