"""What importing the packages loads, and what the repository must never hold."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize(
    ("module", "never"),
    [
        ("teleop.pipeline", "pybullet"),
        ("robot_sim.kinematics", "pybullet"),
        ("teleop.pipeline", "fastapi"),
        ("server.cli", "numba"),
    ],
)
def test_import_stays_light(module: str, never: str) -> None:
    code = f"import sys, {module}; sys.exit({never!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT).returncode == 0, f"{module} loads {never}"


def tracked() -> list[Path]:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout
    return [ROOT / name for name in listed.decode().split("\0") if name]


def test_sizes_of_models_and_recordings() -> None:
    files = [p for p in tracked() if p.exists()]
    models = [p for p in files if p.parent.name == "models"]
    recordings = [p for p in files if p.parent.name == "recordings"]
    assert models
    assert recordings
    assert max(p.stat().st_size for p in models) <= 20e6
    assert sum(p.stat().st_size for p in recordings) <= 60e6


def test_lock_files_name_no_registry() -> None:
    assert "://" not in (ROOT / "constraints.txt").read_text()
    assert '"resolved"' not in (ROOT / "web" / "package-lock.json").read_text()
