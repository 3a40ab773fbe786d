"""Build the wheel, install it in an empty environment without Node, and use it: console, recording, documentation."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import httpx
from rich.console import Console

ROOT = Path(__file__).resolve().parents[1]
START_S = 600.0
"""Kernels are compiled at the first start."""


def main() -> bool:
    """Print the wheel's size and how long each step took; raises SystemExit at what does not work."""
    out = Console()
    with tempfile.TemporaryDirectory(prefix="teleop-wheel-") as folder:
        wheel = build(Path(folder))
        names = zipfile.ZipFile(wheel).namelist()
        for needed in ("server/console/index.html", "server/recordings/greenhouse_demo.mcap", "teleop/models/body.npz"):
            _must(needed in names, f"{wheel.name} lacks {needed}")
        out.print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {len(names)} files")
        begun = time.monotonic()
        python = install(wheel, Path(folder) / "empty")
        out.print(f"installed in an empty environment in {time.monotonic() - begun:.0f} s")
        begun = time.monotonic()
        use(python, Path(folder))
        out.print(f"serves console, documentation and the bundled recording after {time.monotonic() - begun:.0f} s")
    return True


def build(folder: Path) -> Path:
    """``python -m build --wheel``, as a release is made."""
    clean = folder / "source"  # what an earlier build left behind must not get in
    clean.mkdir()
    for name in ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE", "constraints.txt"):
        shutil.copy(ROOT / name, clean)
    for name in ("robot_sim", "teleop", "server", "recordings"):
        shutil.copytree(ROOT / name, clean / name, ignore=shutil.ignore_patterns("__pycache__"))
    command = [sys.executable, "-m", "build", "--wheel", "--outdir", str(folder), str(clean)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=_environment())
    (wheel,) = folder.glob("*.whl")
    return wheel


def install(wheel: Path, environment: Path) -> Path:
    """Its interpreter. Only the wheel and what it asks for are installed."""
    subprocess.run([sys.executable, "-m", "venv", str(environment)], check=True)
    python = environment / "bin" / "python"
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "-c", str(ROOT / "constraints.txt"), str(wheel)], check=True, env=_environment())
    return python


def _environment() -> dict[str, str]:
    """This one without what would let the source tree's modules in."""
    return {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}


def use(python: Path, folder: Path) -> None:
    """Serve from a folder that is not the project's, with nothing but the environment on PATH."""
    path = str(python.parent)
    _must(shutil.which("node", path=path) is None, "there is a Node in the environment")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    home = folder / "home"
    home.mkdir()
    clean = {"PATH": path, "HOME": str(home), "LANG": os.environ.get("LANG", "C.UTF-8")}
    command = [path + "/teleop", "serve", "--port", str(port), "--source", "greenhouse_demo", "--loop"]
    process = subprocess.Popen(command, cwd=home, env=clean, stdout=subprocess.DEVNULL)
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=20) as api:
            end_s = time.monotonic() + START_S
            while not _tracks(api):
                _must(process.poll() is None and time.monotonic() < end_s, "the installed server does not track")
                time.sleep(0.5)
            page = api.get("/").text
            script = page.split('src="', 1)[1].split('"', 1)[0].lstrip(".")
            _must(api.get(script).status_code == 200, f"the console's {script} is missing")
            _must(api.get("/docs-assets/swagger-ui-bundle.js").status_code == 200, "the documentation is missing")
            _must(api.get("/api/v1/recordings").json()[0]["bundled"], "the bundled recording is missing")
    finally:
        process.terminate()
        _must(process.wait(30) == 0, "the installed server did not end well")


def _tracks(api: httpx.Client) -> bool:
    try:
        answer = api.get("/api/v1/state")
    except httpx.TransportError:
        return False
    return answer.status_code == 200 and answer.json()["skeleton"] is not None


def _must(true: bool, otherwise: str) -> None:
    if not true:
        raise SystemExit(f"bench: {otherwise}")


if __name__ == "__main__":
    main()
