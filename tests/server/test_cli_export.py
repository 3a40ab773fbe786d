"""``teleop export`` of a recording with rows and of one without."""

from __future__ import annotations

import csv
from pathlib import Path

import cv2
import numpy as np
import pytest
import typer
from live_server import frames, write_walk
from typer.testing import CliRunner

from server.cli.export import export
from server.cli.record import record
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.errors import TeleopError
from teleop.pipeline import Pipeline
from teleop.recording import McapWriter
from teleop.sources import open_source
from teleop.track_row import track_row

app = typer.Typer()
app.command()(export)
app.command()(record)


def run(*words: str | Path) -> str:
    """Output of a command that works; the error of one that fails is raised."""
    result = CliRunner().invoke(app, [str(word) for word in words])
    if isinstance(result.exception, TeleopError):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.output


def read_table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write_with_rows(path: Path, count: int) -> Path:
    config = TeleopConfig()
    pipeline = Pipeline(BodyTracker(load_model(), config.body), config)
    state = pipeline.initial_state(assume_engaged=True)
    with McapWriter(path, frames()[0].camera, source_uri="made by a test") as writer:
        for frame in frames()[:count]:
            output, state = pipeline.step(frame, state)
            writer.write_frame(frame)
            writer.write_row(frame.t_ns, track_row(output.track, output.intent, output.command) | {"mode": "marked"})
    return path


def test_recorded_rows_are_exported_and_lacking_ones_made(tmp_path: Path) -> None:
    whole, bare = write_with_rows(tmp_path / "whole.mcap", 20), write_walk(tmp_path / "bare.mcap", 20)
    assert "20 frames" in run("export", whole, tmp_path / "whole.csv")
    run("export", bare, tmp_path / "bare.csv")
    recorded, made = read_table(tmp_path / "whole.csv"), read_table(tmp_path / "bare.csv")
    assert len(recorded) == len(made) == 20
    assert {row["mode"] for row in recorded} == {"marked"} and "marked" not in {row["mode"] for row in made}
    last = np.array([[float(row["head_x_m"]), float(row["head_z_m"])] for row in (recorded[-1], made[-1])])
    assert np.ptp(last, axis=0).max() < 0.05, "the same person; colour went through JPEG on one way"


def test_a_film_has_as_many_seconds_as_the_recording(tmp_path: Path) -> None:
    path = write_with_rows(tmp_path / "whole.mcap", 20)
    run("export", path, tmp_path / "film.mp4", "--rate-hz", "20")
    film = cv2.VideoCapture(str(tmp_path / "film.mp4"))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == 20
    ok, picture = film.read()
    assert ok and picture.shape == (480, 1280, 3)


def test_a_dump_for_fakenect_opens_again(tmp_path: Path) -> None:
    path = write_walk(tmp_path / "bare.mcap", 3)
    run("export", path, tmp_path / "dump.fakenect")
    source = open_source(str(tmp_path / "dump.fakenect"))
    assert sum(1 for _ in source.frames()) == 3
    source.close()


def test_refusals(tmp_path: Path) -> None:
    path = write_walk(tmp_path / "bare.mcap", 2)
    (tmp_path / "old.csv").write_text("mine")
    with pytest.raises(TeleopError, match="exists already"):
        run("export", path, tmp_path / "old.csv")
    assert (tmp_path / "old.csv").read_text() == "mine"
    run("export", path, tmp_path / "old.csv", "--force")
    assert len(read_table(tmp_path / "old.csv")) == 2
    with pytest.raises(TeleopError, match="create it first"):
        run("export", path, tmp_path / "missing" / "a.mp4")
    for words in (("export", path, tmp_path / "a.txt"), ("record", path, tmp_path / "folder")):
        result = CliRunner().invoke(app, [str(word) for word in words])
        assert result.exit_code == 2
    with pytest.raises(TeleopError, match="is the source itself"):
        run("record", path, path, "--force")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bare.mcap", "old.csv"]


def test_recording_a_part_by_the_command(tmp_path: Path) -> None:
    path = write_walk(tmp_path / "bare.mcap", 12)
    assert "7 frames recorded" in run("record", path, tmp_path / "out.mcap", "--seconds", "0.3", "--no-color")
    source = open_source(str(tmp_path / "out.mcap"))
    assert [frame.color_rgb for frame in source.frames()] == [None] * 7
    source.close()
