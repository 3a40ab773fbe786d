"""``teleop track`` over a folder: in processes, on a real Dask cluster, again after an interruption, with bad files."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from cli_process import teleop

from server.cli.track_archive import DONE, track_archive
from server.cli.track_run import load_config
from server.settings import bundled_recordings
from teleop.parallel import Outcome, open_pool
from teleop.recording import McapSource, McapWriter
from teleop.recording.archive import is_archive, recordings_in
from teleop.recording.convert import convert
from teleop.software import library_digest

FRAMES = 4
NAMES = ["a.mcap", "folder", "sub/b.mcap"]


class Here:
    """A pool in this process that can be interrupted."""

    workers = 1

    def __init__(self, most: int = 100) -> None:
        self.done: list[str] = []
        self._most = most

    def run(self, work: Callable[[Any], Any], tasks: Sequence[Any]) -> Iterator[Outcome[Any, Any]]:
        for number, task in enumerate(tasks):
            if len(self.done) == self._most:
                raise KeyboardInterrupt
            self.done.append(task.name)
            yield Outcome(number, task, work(task))

    def close(self) -> None:
        """Nothing to end."""


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings and an RGB-D folder."""
    folder = tmp_path_factory.mktemp("archive")
    (folder / "sub").mkdir()
    demo = McapSource(bundled_recordings() / "greenhouse_demo.mcap")
    for name, from_s in (("a.mcap", 20.0), ("sub/b.mcap", 22.0)):
        with McapWriter(folder / name, demo.info.camera, source_uri="piece") as writer:
            for frame in islice(demo.frames(from_s), FRAMES):
                writer.write_frame(frame)
    convert(demo, folder / "folder", from_s=24.0, seconds=0.1)
    demo.close()
    return folder


def tracked(folder: Path, output: Path, pool: Any) -> Any:
    return track_archive(folder, output, load_config(None, no_filter=False), pool, lambda *_: None)


def contents(output: Path) -> dict[str, bytes]:
    return {p.relative_to(output).as_posix(): p.read_bytes() for p in sorted(output.rglob("*.jsonl"))}


@pytest.fixture(scope="module")
def whole(archive: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    output = tmp_path_factory.mktemp("whole")
    summary = tracked(archive, output, Here())
    assert summary.tracked == 3 and not summary.failed and summary.frames == 2 * FRAMES + 3
    return contents(output)


def test_recordings_are_found_by_what_they_are(archive: Path) -> None:
    assert [p.relative_to(archive).as_posix() for p in recordings_in(archive)] == NAMES
    assert is_archive(archive) and not is_archive(archive / "folder") and not is_archive(archive / "a.mcap")


def test_every_recording_has_its_rows(whole: dict[str, bytes]) -> None:
    assert list(whole) == [f"{name}.jsonl" for name in NAMES]
    rows = [json.loads(line) for line in whole["a.mcap.jsonl"].splitlines()]
    assert len(rows) == FRAMES and rows[-1]["joints"]["head"] is not None


def test_an_interrupted_run_goes_on(archive: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    first = Here(most=1)
    with pytest.raises(KeyboardInterrupt):
        tracked(archive, tmp_path, first)
    second = Here()
    summary = tracked(archive, tmp_path, second)
    assert (summary.left, summary.tracked) == (1, 2)
    assert sorted(first.done + second.done) == NAMES
    assert contents(tmp_path) == whole
    (tmp_path / "a.mcap.jsonl").unlink()
    third = Here()
    tracked(archive, tmp_path, third)
    assert third.done == ["a.mcap"] and contents(tmp_path) == whole
    other = load_config(None, no_filter=True)
    fourth = Here()
    track_archive(archive, tmp_path, other, fourth, lambda *_: None)
    assert sorted(fourth.done) == NAMES  # other settings, other rows


def test_a_dask_cluster_gives_the_same_rows(archive: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: extra 'cluster'")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
        ) as cluster,
        open_pool(None, cluster.scheduler_address, library_digest) as pool,
    ):
        summary = tracked(archive, tmp_path, pool)
    assert summary.tracked == 3 and contents(tmp_path) == whole


def test_what_fails_is_told_in_one_line_each(archive: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    folder, output = tmp_path / "in", tmp_path / "out"
    folder.mkdir()
    (folder / "good.mcap").write_bytes((archive / "a.mcap").read_bytes())
    (folder / "empty.mcap").touch()
    (folder / "noise.bag").write_bytes(b"no bag")
    result = teleop("track", folder, "--output", output, "--workers", "2", timeout_s=240)
    assert result.returncode == 1 and "Traceback" not in result.stderr, result.stderr
    said = [line for line in result.stderr.splitlines() if line.startswith("teleop: ")]
    assert [line.split(":")[1].strip() for line in said] == ["empty.mcap", "noise.bag"] and "is empty" in said[0]
    assert "1 recordings tracked (4 frames), 0 done before, 2 failed" in result.stdout
    assert contents(output) == {"good.mcap.jsonl": whole["a.mcap.jsonl"]}
    assert not list(output.glob(".*.part")) and (output / DONE).is_file()


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("{empty}", "--output", "{tmp}/rows"), 1, "holds no recordings"),
        (("{archive}", "--output", "{archive}/rows"), 1, "the source itself or lies in it"),
        (("{archive}", "--output", "{archive}/a.mcap"), 2, "--output must be one"),
        (("{archive}/a.mcap", "--output", "{tmp}/x", "--workers", "2"), 2, "are for a folder of recordings"),
        (("{archive}", "--output", "{tmp}/rows", "--scheduler", "nowhere"), 1, "no Dask scheduler at nowhere"),
    ],
)
def test_wrong_usage_is_one_line(
    archive: Path, tmp_path: Path, options: tuple[str, ...], code: int, words: str
) -> None:
    (tmp_path / "empty").mkdir()
    given = [o.format(archive=archive, tmp=tmp_path, empty=tmp_path / "empty") for o in options]
    result = teleop("track", *given)
    assert result.returncode == code and words in result.stderr and "Traceback" not in result.stderr, result.stderr
