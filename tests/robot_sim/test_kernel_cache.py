"""Compiled kernels are kept by the sources they were made from."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from robot_sim.kernel_cache import VARIABLE, _forget, keep_kernels, kernels_digest, kernels_folder

INNER = "import numba\n@numba.njit(cache=True)\ndef inner(x):\n    return x + {}\n"
OUTER = (
    "import numba\nfrom inner import inner\n"
    "@numba.njit(cache=True)\ndef outer(x):\n    return inner(x)\nprint(outer(1))\n"
)


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own; the environment is put back afterwards."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv(VARIABLE, raising=False)
    return kernels_folder()


def test_a_kernel_that_calls_a_changed_one_is_made_anew(home: Path, tmp_path: Path) -> None:
    package = tmp_path / "package"
    package.mkdir()
    (package / "outer.py").write_text(OUTER)
    said = []
    for number in (1, 2):
        (package / "inner.py").write_text(INNER.format(number))
        folder = str(home / kernels_digest(str(package))[:16])
        environment = {**os.environ, VARIABLE: folder}
        done = subprocess.run(
            [sys.executable, "outer.py"], cwd=package, env=environment, capture_output=True, text=True, check=True
        )
        said.append(done.stdout.strip())
        assert any(Path(folder).rglob("*.nbi"))
    assert said == ["2", "3"]


def test_only_files_with_kernels_count(tmp_path: Path) -> None:
    (tmp_path / "kernel.py").write_text(INNER.format(1))
    before = kernels_digest(str(tmp_path))
    (tmp_path / "words.py").write_text("print('hello')\n")
    assert kernels_digest(str(tmp_path)) == before
    (tmp_path / "kernel.py").write_text(INNER.format(2))
    assert kernels_digest(str(tmp_path)) != before


def test_a_folder_of_ones_own_is_left_alone(home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "mine"))
    assert keep_kernels(str(tmp_path)) is None
    assert os.environ[VARIABLE] == str(tmp_path / "mine") and not home.exists()


def test_kernels_that_nobody_uses_any_more_are_deleted(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    numba = sys.modules.get("numba")
    if numba is not None:
        monkeypatch.setattr(numba.config, "CACHE_DIR", numba.config.CACHE_DIR)
    monkeypatch.setenv(VARIABLE, str(home / "of the last state"))
    for name, age_s in (("old", 40 * 86400.0), ("young", 86400.0)):
        (home / name).mkdir(parents=True)
        stamp = (home / name).stat().st_mtime - age_s
        os.utime(home / name, (stamp, stamp))
    own = keep_kernels(str(tmp_path))
    assert own is not None and os.environ[VARIABLE] == str(own)
    assert sorted(p.name for p in home.iterdir()) == sorted(["young", own.name])


def test_without_a_home_or_where_it_cannot_be_written_numba_chooses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    (tmp_path / "file").write_text("")
    for cache in (str(tmp_path / "file"), "not/absolute"):
        monkeypatch.setenv("XDG_CACHE_HOME", cache)
        assert keep_kernels(str(tmp_path)) is None
    monkeypatch.delenv("XDG_CACHE_HOME")

    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    assert keep_kernels(str(tmp_path)) is None
    assert VARIABLE not in os.environ


def test_a_folder_that_another_process_deletes_is_no_matter(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = home / "own"
    own.mkdir(parents=True)
    monkeypatch.setattr(Path, "iterdir", lambda self: iter([home / "gone", own]))
    _forget(home, own)
    assert own.exists()


@pytest.mark.parametrize("package", ["robot_sim", "teleop"])
def test_kernels_use_nothing_of_files_without_kernels(package: str) -> None:
    root = Path(__file__).parents[2]
    for path in sorted((root / package).rglob("*.py")):
        source = path.read_text()
        if "njit" not in source:
            continue
        tree = ast.parse(source)
        foreign = {
            alias.asname or alias.name: node.module
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in ("robot_sim", "teleop")
            for alias in node.names
        }
        kernels = [
            node
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef) and any("njit" in ast.unparse(d) for d in node.decorator_list)
        ]
        for kernel in kernels:
            for node in (n for line in kernel.body for n in ast.walk(line)):
                if isinstance(node, ast.Name) and node.id in foreign:
                    module = foreign[node.id]
                    assert module is not None
                    text = (root / Path(*module.split("."))).with_suffix(".py").read_text()
                    assert "njit" in text, f"{path.name}: {kernel.name} uses {node.id} of {module}"
