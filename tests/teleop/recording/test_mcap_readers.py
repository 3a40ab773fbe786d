"""The same recording read by @mcap/core in Node and by the ``mcap`` package: the same messages."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from recording_frames import camera, frames

from teleop.recording import McapWriter, topics
from teleop.recording.repair import repair

ROOT = Path(__file__).resolve().parents[3]
WEB = ROOT / "web"
SCRIPT = ROOT / "tests" / "mcap_js" / "read_mcap.mjs"


def node() -> str:
    """The Node of the repository's setup: the system's, or the one in the virtual environment."""
    places = f"{ROOT / '.venv' / 'node-bin'}{os.pathsep}{os.environ.get('PATH', '')}"
    return shutil.which("node", path=places) or pytest.skip("no Node here; 'make setup' brings it")


def by_javascript(path: Path) -> dict[str, Any]:
    if not (WEB / "node_modules" / "@mcap" / "core").is_dir():
        pytest.skip("@mcap/core is not installed; 'make setup' brings it")
    command = [node(), str(SCRIPT), str(WEB), str(path)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert result.returncode == 0, result.stderr[-2000:]
    return dict(json.loads(result.stdout))


def by_python(path: Path) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            entry = {"schema": schema.name, "encoding": channel.message_encoding, "times": [], "digests": []}
            topic = found.setdefault(channel.topic, entry)
            decoder = DecoderFactory().decoder_for(channel.message_encoding, schema)
            decoded = decoder(message.data) if decoder is not None else None
            data = getattr(decoded, "data", message.data)
            topic["times"].append(str(message.log_time))
            topic["digests"].append(hashlib.sha256(data).hexdigest())
    return found


@pytest.mark.parametrize("cut", [False, True], ids=["whole", "cut off and repaired"])
def test_javascript_and_python_read_the_same(tmp_path: Path, cut: bool) -> None:
    path = tmp_path / "a.mcap"
    written = frames(60, color=True)
    with McapWriter(path, camera(), source_uri="virtual:") as writer:
        for frame in written:
            writer.write_frame(frame)
            writer.write_row(frame.t_ns, {"t": frame.t_s})
            writer.write_skeleton(frame.t_ns, None)
    if cut:
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) * 2 // 3])
        repair(path)
    found, expected = by_javascript(path), by_python(path)
    assert found["ordered"]
    assert found["messages"] == sum(len(topic["times"]) for topic in expected.values())
    assert {name: {k: t[k] for k in expected[name]} for name, t in found["topics"].items()} == expected
    assert found["metadata"]["teleop"]["source"] == "virtual:"
    depth = found["topics"][topics.DEPTH]
    kept = len(depth["times"])
    assert kept == 60 if not cut else 10 < kept < 60
    assert set(depth["encodings"]) == {"16UC1"}
    assert depth["times"] == [str(f.t_ns) for f in written[:kept]]
    assert depth["digests"] == [hashlib.sha256(f.depth_mm.tobytes()).hexdigest() for f in written[:kept]]
