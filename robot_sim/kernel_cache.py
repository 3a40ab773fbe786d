"""Where numba keeps compiled kernels: a folder for each state of the sources.

By itself it knows a kernel by the date of its own file alone. A kernel that calls one of another file, which was
changed since, would go on with the old one: a program of two versions, whose answers are wrong without a word.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Final

VARIABLE: Final = "NUMBA_CACHE_DIR"
_UNUSED_S: Final = 30 * 24 * 3600.0
"""Kernels of sources that nobody ran for so long are deleted."""


def kernels_folder() -> Path:
    """The folder of all states, in the user's cache. Raises RuntimeError where the user has no home."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    if not base.is_absolute():
        raise RuntimeError(f"the user's cache '{base}' is no absolute path")
    return base / "greenhouse-teleop" / "kernels"


def kernels_digest(*folders: str) -> str:
    """SHA-256 of all Python files below the folders that hold a kernel. A kernel uses nothing of any other file but
    modules (tested)."""
    digest = hashlib.sha256()
    for folder in folders:
        root = Path(folder)
        for path in sorted(root.rglob("*.py")):
            source = path.read_bytes()
            if b"njit" in source:
                digest.update(f"{path.relative_to(root)} {len(source)}\n".encode())
                digest.update(source)
    return digest.hexdigest()


def keep_kernels(*folders: str) -> Path | None:
    """From now on keep kernels in the folder of these packages' sources, which is returned.

    None, and numba's own choice, where the environment names a folder of somebody's own or the cache cannot be written.
    """
    try:
        home = kernels_folder()
        chosen = os.environ.get(VARIABLE)
        if chosen and Path(chosen).parent != home:
            return None
        own = home / kernels_digest(*folders)[:16]
        own.mkdir(parents=True, exist_ok=True)
        os.utime(own)
        if not os.access(own, os.W_OK):
            return None
        _forget(home, own)
    except (OSError, RuntimeError):
        return None
    os.environ[VARIABLE] = str(own)
    numba = sys.modules.get("numba")
    if numba is not None:
        numba.config.CACHE_DIR = str(own)
    return own


def _forget(home: Path, own: Path) -> None:
    oldest = time.time() - _UNUSED_S
    for other in home.iterdir():
        # another process may be deleting the same
        with suppress(FileNotFoundError):
            if other != own and other.stat().st_mtime < oldest:
                shutil.rmtree(other, ignore_errors=True)
