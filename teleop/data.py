"""Where the reference data sets lie: $TELEOP_DATA, else ../shared/data beside the checkout."""

from __future__ import annotations

import os
from pathlib import Path

from teleop.errors import DataError


def data_root() -> Path | None:
    """Folder of the data sets, or None when there is none. The product works fully without it."""
    named = os.environ.get("TELEOP_DATA")
    candidates = [Path(named)] if named else [Path(__file__).resolve().parents[2] / "shared" / "data"]
    return next((c for c in candidates if c.is_dir()), None)


def data_folder(name: str) -> Path:
    """Folder of one data set, such as ``makehuman``. Raises DataError when it is not there."""
    root = data_root()
    if root is None or not (root / name).is_dir():
        raise DataError(
            f"data set '{name}' not found; set TELEOP_DATA to the folder that holds it "
            "(MakeHuman's base mesh, rig and targets come from the MakeHuman project)"
        )
    return root / name
