"""Long jobs over a recording, its story and its picture, over the API as a researcher uses them."""

from __future__ import annotations

import csv
import json
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from live_server import running, write_walk

from server.client import TeleopClient
from server.errors import Refused
from server.jobs import Job
from teleop.intent_types import Event
from teleop.recording import McapSource, McapWriter

FEW = 8


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("jobs")


@pytest.fixture(scope="module")
def client(folder: Path) -> Iterator[TeleopClient]:
    with running(folder) as (url, _), TeleopClient(url) as client:
        yield client


@pytest.fixture(scope="module")
def short(client: TeleopClient, folder: Path) -> str:
    """A recording of few frames."""
    return client.upload(write_walk(folder / "short.mcap", FEW)).id


def done(client: TeleopClient, job: Job) -> Job:
    job = client.wait(job.id)
    assert (job.status, job.error) == ("done", None)
    assert job.progress == 1.0
    return job


@pytest.mark.parametrize("kind", ["csv", "lerobot"])
def test_a_recording_is_exported_and_fetched(client: TeleopClient, short: str, tmp_path: Path, kind: str) -> None:
    job = done(client, client.export(short, kind))
    assert (job.kind, job.detail) == (f"export {kind}", short)
    assert job.result is not None
    assert job.result["frames"] == FEW
    path = tmp_path / job.result["file"]
    client.download_file(job.id, path)
    assert path.stat().st_size == job.result["bytes"]
    if kind == "csv":
        with path.open(newline="") as file:
            assert len(list(csv.reader(file))) == FEW + 1
    elif kind == "lerobot":
        assert any(name.endswith("meta/info.json") for name in zipfile.ZipFile(path).namelist())
    client.cancel_job(job.id)
    with pytest.raises(Refused, match="no file"):
        client.download_file(job.id, path)


def test_a_recording_is_tracked_anew(client: TeleopClient, short: str, tmp_path: Path) -> None:
    job = done(client, client.track(short))
    client.download_file(job.id, tmp_path / "rows.jsonl")
    rows = [json.loads(line) for line in (tmp_path / "rows.jsonl").read_text().splitlines()]
    assert len(rows) == FEW
    assert rows[-1]["joints"]["head"] is not None


def test_frames_alone_cannot_be_verified_and_the_job_says_why(client: TeleopClient) -> None:
    failed = client.wait(client.verify("walk").id)
    assert failed.status == "failed"
    assert "teleop record" in (failed.error or "")


def test_wrong_settings_and_formats_are_refused_before_a_job_begins(client: TeleopClient) -> None:
    count = len(client.jobs())
    for path, body in (
        ("whatif", {"settings": {"teleop": {"intent": {"wings": 1}}}}),
        ("export", {"format": "docx"}),
        ("whatif", {}),
    ):
        with pytest.raises(Refused) as refusal:
            client.request("POST", f"/recordings/walk/{path}", body)
        assert refusal.value.status == 422
    with pytest.raises(Refused) as refusal:
        client.export("nothing", "csv")
    assert refusal.value.status == 404
    assert len(client.jobs()) == count


def test_the_story_tells_events_and_modes_by_position(client: TeleopClient, folder: Path) -> None:
    own = folder / "own"
    own.mkdir(exist_ok=True)
    source = McapSource(write_walk(folder / "frames.mcap", 10))
    frames = list(source.frames())
    with McapWriter(own / "told.mcap", frames[0].camera, source_uri="made by a test") as writer:
        for i, frame in enumerate(frames):
            writer.write_frame(frame)
            writer.write_row(frame.t_ns, {"mode": "seen" if i < 4 else "engaged"})
            if i == 4:
                writer.write_event(Event(frame.t_ns, "mode", "mode.engage_gesture", "seen -> engaged"))
    source.close()
    story = client.story("told")
    at_s = round((frames[4].t_ns - frames[0].t_ns) * 1e-9, 2)
    assert [(m.position_s, m.mode) for m in story.modes] == [(0.0, "seen"), (at_s, "engaged")]
    assert [(e.position_s, e.reason) for e in story.events] == [(at_s, "mode.engage_gesture")]
    assert client.story("walk").events == []


def test_a_recording_has_a_picture(client: TeleopClient) -> None:
    response = client._send("GET", "/recordings/walk/preview.jpg")
    assert response.headers["content-type"] == "image/jpeg"
    assert response.content[:2] == b"\xff\xd8"
