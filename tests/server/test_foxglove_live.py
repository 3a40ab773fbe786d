"""The live view is spoken to as Foxglove does: websocket, protocol ``foxglove.sdk.v1``, subscriptions, protobuf."""

from __future__ import annotations

import json
import struct
import time
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from live_server import frames, running
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from server.errors import ServerError
from server.foxglove_live import HOST, FoxgloveLive
from teleop.recording import topics

DEADLINE_S = 60.0
_MESSAGE = struct.Struct("<BIQ")


def subscribe(line: ClientConnection, wanted: set[str]) -> dict[int, dict[str, Any]]:
    """Read what is advertised and subscribe; the channels by the number of their subscription."""
    channels: dict[str, dict[str, Any]] = {}
    while not wanted <= set(channels):
        message = line.recv(timeout=DEADLINE_S)
        if isinstance(message, str) and (told := json.loads(message))["op"] == "advertise":
            channels |= {channel["topic"]: channel for channel in told["channels"]}
    numbered = {number: channels[topic] for number, topic in enumerate(sorted(wanted), start=1)}
    asked = [{"id": number, "channelId": channel["id"]} for number, channel in numbered.items()]
    line.send(json.dumps({"op": "subscribe", "subscriptions": asked}))
    return numbered


def decoded(channel: dict[str, Any], data: bytes) -> Any:
    if channel["encoding"] == "json":
        return json.loads(data)
    import base64

    pool = DescriptorPool()
    for file in FileDescriptorSet.FromString(base64.b64decode(channel["schema"])).file:
        pool.Add(file)  # type: ignore[no-untyped-call]
    message = GetMessageClass(pool.FindMessageTypeByName(channel["schemaName"]))()
    message.ParseFromString(data)
    return message


def collect(line: ClientConnection, numbered: dict[int, dict[str, Any]]) -> dict[str, list[tuple[int, Any]]]:
    found: dict[str, list[tuple[int, Any]]] = {channel["topic"]: [] for channel in numbered.values()}
    end_s = time.monotonic() + DEADLINE_S
    while (
        any(len(messages) < 2 for topic, messages in found.items() if topic != topics.ROBOT_DESCRIPTION)
        or not found[topics.ROBOT_DESCRIPTION]
    ):
        assert time.monotonic() < end_s, {topic: len(messages) for topic, messages in found.items()}
        message = line.recv(timeout=DEADLINE_S)
        if isinstance(message, bytes) and message[0] == 1:
            _, number, t_ns = _MESSAGE.unpack_from(message)
            channel = numbered[number]
            found[channel["topic"]].append((t_ns, decoded(channel, message[_MESSAGE.size :])))
    return found


def test_a_viewer_sees_the_recordings_topics(tmp_path: Path) -> None:
    with running(tmp_path) as (url, engine):
        live = FoxgloveLive(engine.urdf, 0, 90)
        live.start()
        engine.on_moment = live.offer
        try:
            httpx.post(f"{url}/api/v1/sessions", json={"source": "walk", "loop": True}, timeout=60).raise_for_status()
            wanted = {
                topics.DEPTH,
                topics.DEPTH_INFO,
                topics.COLOR,
                topics.JOINT_STATES,
                topics.TF,
                topics.ROBOT_DESCRIPTION,
                topics.SKELETON,
                topics.TRACK,
                topics.INPUTS,
            }
            protocol = [Subprotocol("foxglove.sdk.v1"), Subprotocol("foxglove.websocket.v1")]
            with connect(f"ws://{HOST}:{live.port}", subprotocols=protocol, max_size=1 << 24) as line:
                assert line.subprotocol in protocol
                numbered = subscribe(line, wanted)
                found = collect(line, numbered)
        finally:
            engine.on_moment = None
            live.stop()
    schemas = {channel["topic"]: channel["schemaName"] for channel in numbered.values()}
    assert schemas[topics.DEPTH] == "foxglove.RawImage" and schemas[topics.SKELETON] == "foxglove.SceneUpdate"
    assert schemas[topics.TRACK] == "teleop.Track"
    known = {frame.depth_mm.tobytes() for frame in frames()}
    for t_ns, image in found[topics.DEPTH]:
        assert image.encoding == "16UC1" and image.data in known
        assert abs(t_ns * 1e-9 - time.time()) < 600
    for messages in found.values():
        stamps = [t_ns for t_ns, _ in messages]
        assert stamps == sorted(stamps)
    info = found[topics.DEPTH_INFO][0][1]
    np.testing.assert_allclose(info.K[0], frames()[0].camera.depth.fx)
    assert found[topics.ROBOT_DESCRIPTION][0][1]["data"].startswith("<")
    assert {"joints", "zone", "command"} <= set(found[topics.TRACK][0][1])
    assert found[topics.JOINT_STATES][0][1].joints


def test_a_port_in_use_is_one_error() -> None:
    urdf = "<robot name='r'><link name='base'/></robot>"
    first = FoxgloveLive(urdf, 0, 90)
    try:
        with pytest.raises(ServerError, match=f"port {first.port}.*--foxglove-port"):
            FoxgloveLive(urdf, first.port, 90)
    finally:
        first.stop()
