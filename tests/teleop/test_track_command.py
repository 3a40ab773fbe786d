"""``teleop track`` through the real command line, on a piece of the bundled recording."""

import json
import subprocess
import sys
from itertools import islice
from pathlib import Path

import pytest

from teleop.joints import JOINT_NAMES
from teleop.recording import McapWriter
from teleop.sources import open_source

RECORDING = Path(__file__).parents[2] / "recordings" / "greenhouse_demo.mcap"
FRAMES = 12


def teleop(*arguments: str) -> subprocess.CompletedProcess[str]:
    code = "from server.cli import main; main()"
    return subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=240)


@pytest.fixture(scope="module")
def piece(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A few frames of the recording with the operator in the working zone."""
    if not RECORDING.exists():
        pytest.skip("the bundled recording is not there; make it with python -m teleop.people.demo_recording")
    path = tmp_path_factory.mktemp("piece") / "piece.mcap"
    source = open_source(str(RECORDING))
    with McapWriter(path, source.info.camera, source_uri="piece") as writer:
        for frame in islice(source.frames(from_s=20.0), FRAMES):
            writer.write_frame(frame)
    source.close()
    return path


@pytest.mark.parametrize("options", [(), ("--no-filter",)])
def test_one_valid_row_per_frame_in_order(piece: Path, tmp_path: Path, options: tuple[str, ...]) -> None:
    output = tmp_path / "rows.jsonl"
    run = teleop("track", str(piece), "--output", str(output), *options)
    assert run.returncode == 0, run.stderr
    assert f"{FRAMES} frames, person in {FRAMES}" in run.stdout

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is not JSON")

    rows = [json.loads(line, parse_constant=refuse) for line in output.read_text().splitlines()]
    assert len(rows) == FRAMES
    assert [row["t"] for row in rows] == sorted(row["t"] for row in rows)
    for row in rows:
        assert list(row["joints"]) == list(JOINT_NAMES)
        assert row["joints"]["head"] is not None
    assert rows[-1]["zone"] == "work"
    assert rows[-1]["mode"] in ("engaged", "picking")


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("track", "nosuch.mcap", "--output", "{tmp}/x.jsonl"), 1, "nosuch.mcap"),
        (("track", "foo:bar", "--output", "{tmp}/x.jsonl"), 1, "legal are"),
        (("track", "{piece}", "--output", "{tmp}/none/x.jsonl"), 1, "choose another --output"),
        (("track", "{piece}", "--output", "{tmp}/x.jsonl", "--config", "{tmp}/bad.toml"), 1, "less than or equal to 5"),
        (("track", "{piece}", "--output", "{tmp}/x.jsonl", "--config", "{tmp}/none.toml"), 1, "no configuration file"),
        (("track", "{piece}", "--output", "{piece}"), 1, "the source itself"),
        (("track", "{piece}", "--output", "{tmp}"), 1, "a folder"),
        (("track", "{piece}"), 2, "--output"),
        (("track", "{piece}", "--output", "{tmp}/x.jsonl", "--colour"), 2, "--colour"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(
    piece: Path, tmp_path: Path, arguments: tuple[str, ...], code: int, words: str
) -> None:
    (tmp_path / "bad.toml").write_text("[teleop.intent.zones]\nl1_m = 99\n")
    run = teleop(*(argument.format(tmp=tmp_path, piece=piece) for argument in arguments))
    assert run.returncode == code
    assert words in run.stderr
    assert "Traceback" not in run.stderr
    assert len(run.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "x.jsonl").exists()
