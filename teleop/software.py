"""Which software this is: its version, and a digest of the sources that says more than a version can."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path


def software_version() -> str:
    """Version of the installed distribution."""
    try:
        return version("greenhouse-teleop")
    except PackageNotFoundError:
        return "unknown"


@cache
def sources_digest(*packages: str, without: tuple[str, ...] = ()) -> str:
    """SHA-256 of the Python sources of the packages; empty where there are none (a frozen program).

    packages, without: dotted names, such as ``teleop`` and ``teleop.training``.
    """
    digest = hashlib.sha256()
    for package in packages:
        spec = find_spec(package)
        for folder in (spec.submodule_search_locations if spec else None) or ():
            root = Path(folder)
            for path in sorted(root.rglob("*.py")):
                module = ".".join((package, *path.relative_to(root).with_suffix("").parts))
                if not any(f"{module}.".startswith(f"{name}.") for name in without):
                    digest.update(f"{module} {path.stat().st_size}\n".encode())
                    digest.update(path.read_bytes())
    return digest.hexdigest()


def library_digest() -> str:
    """Of everything below the command line; what a worker of a cluster must share with its caller."""
    return sources_digest("robot_sim", "teleop")
