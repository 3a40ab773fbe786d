"""Real sensor libraries without hardware: one clear line each. In child processes: they may crash or exit."""

from __future__ import annotations

import subprocess
import sys

import pytest

from teleop.sources.probe import KINDS, Probe, probe

OPEN = """
import sys
from teleop.errors import SourceError
from teleop.sources.driver_worker import DRIVERS
try:
    kind, _, argument = sys.argv[1].partition(":")
    DRIVERS[kind](argument)
except SourceError as error:
    print("\\nSAID", error, flush=True)
"""


def said(uri: str, prelude: str = "") -> str:
    child = subprocess.run(
        [sys.executable, "-c", prelude + OPEN, uri], capture_output=True, text=True, timeout=60, check=False
    )
    lines = [line for line in child.stdout.splitlines() if line.startswith("SAID")]
    assert len(lines) == 1, child.stdout + child.stderr
    assert "Traceback" not in child.stderr
    return lines[0]


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_without_a_device_the_next_step_is_named(kind: str) -> None:
    found = probe(kind)
    if found.devices:
        pytest.skip(f"a {kind} device is connected: {found.devices[0]}")
    line = said(f"{kind}:")
    assert "teleop doctor" in line
    if found.library is not None:
        assert " no " in line and "found" in line


@pytest.mark.parametrize(
    ("kind", "module", "package"),
    [
        ("openni2", "openni", "openni"),
        ("realsense", "pyrealsense2", "pyrealsense2"),
        ("orbbec", "pyorbbecsdk", "pyorbbecsdk2"),
    ],
)
def test_without_the_package_it_is_named(kind: str, module: str, package: str) -> None:
    line = said(f"{kind}:", f"import sys; sys.modules['{module}'] = None\n")
    assert f"pip install {package}" in line


@pytest.mark.parametrize(("kind", "name"), [("freenect", "libfreenect0.5"), ("openni2", "libopenni2-0")])
def test_without_the_system_library_it_is_named(kind: str, name: str) -> None:
    prelude = (
        "import ctypes, ctypes.util\n"
        "def missing(name, *rest): raise OSError(name)\n"
        "ctypes.CDLL = missing; ctypes.util.find_library = lambda name: None\n"
    )
    line = said(f"{kind}:", prelude)
    assert f"apt install {name}" in line or "pip install" in line


@pytest.mark.parametrize(("kind", "suffix"), [("openni2", ".oni"), ("realsense", ".bag"), ("realsense", ".db3")])
def test_a_file_that_is_none(kind: str, suffix: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("drivers") / f"broken{suffix}"
    path.write_bytes(b"this is no recording " * 500)
    if probe(kind).library is None:
        pytest.skip(f"the {kind} library is not installed here")
    assert "cannot" in said(f"{kind}:{path}")


def test_a_probe_that_crashes_or_hangs_is_a_problem_not_an_exception(monkeypatch: pytest.MonkeyPatch) -> None:
    assert probe("unheard of") == Probe(None, (), "stopped with code 1: KeyError: 'unheard of'")
    assert "within" in probe("freenect", timeout_s=0.001).problem
