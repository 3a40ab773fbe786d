"""What a driver's process and its owner say to each other over a pair of sockets. Blocking calls, no process here.

Every message is ``u8 kind, u32 bytes of JSON, u32 bytes of data``, little endian, then both. The owner asks for frames
(RUN, with where to begin) once; the driver tells its INFO, and when it is asked FRAMEs, then END or ERROR.
"""

from __future__ import annotations

import json
import socket
import struct
from dataclasses import asdict
from enum import IntEnum
from typing import Any

import numpy as np

from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.sources.base import SourceInfo

_HEADER = struct.Struct("<BII")


class Kind(IntEnum):
    """What a message is."""

    RUN = 1
    INFO = 2
    FRAME = 3
    END = 4
    ERROR = 5


def send(sock: socket.socket, kind: Kind, content: dict[str, Any], *data: bytes) -> None:
    """Send one message. Raises OSError when nobody is there."""
    text = json.dumps(content).encode()
    sock.sendall(_HEADER.pack(kind, len(text), sum(map(len, data))) + text)
    for part in data:
        sock.sendall(part)


def receive(sock: socket.socket) -> tuple[Kind, dict[str, Any], bytearray] | None:
    """The next message; None at the end of the line. Raises TimeoutError and OSError."""
    header = _exactly(sock, _HEADER.size)
    if header is None:
        return None
    kind, text_bytes, data_bytes = _HEADER.unpack(header)
    text, data = _exactly(sock, text_bytes), _exactly(sock, data_bytes)
    return None if text is None or data is None else (Kind(kind), json.loads(bytes(text)), data)


def send_frame(sock: socket.socket, frame: DepthFrame) -> None:
    """One frame."""
    color = frame.color_rgb
    content = {
        "t_ns": frame.t_ns,
        "seq": frame.seq,
        "depth": frame.depth_mm.shape,
        "color": None if color is None else color.shape[:2],
    }
    depth = np.ascontiguousarray(frame.depth_mm).tobytes()
    send(sock, Kind.FRAME, content, depth, b"" if color is None else np.ascontiguousarray(color).tobytes())


def frame_of(content: dict[str, Any], data: bytearray, camera: Camera) -> DepthFrame:
    """The frame of a FRAME message. Raises FrameError."""
    height, width = content["depth"]
    depth = np.frombuffer(data, dtype=np.uint16, count=height * width).reshape(height, width)
    depth.flags.writeable = False
    color = None
    if content["color"] is not None:
        rows, columns = content["color"]
        color = np.frombuffer(data, dtype=np.uint8, offset=2 * height * width).reshape(rows, columns, 3)
        color.flags.writeable = False
    return DepthFrame(content["t_ns"], depth, camera, color, content["seq"])


def info_to_json(info: SourceInfo) -> dict[str, Any]:
    """As plain JSON."""
    return asdict(info)


def info_from_json(content: dict[str, Any]) -> SourceInfo:
    """What ``info_to_json`` was given."""
    camera = content["camera"]
    color, matrix = camera["color"], camera["T_color_depth"]
    return SourceInfo(
        **content
        | {
            "camera": Camera(
                Intrinsics(**camera["depth"]),
                camera["mirrored"],
                None if color is None else Intrinsics(**color),
                None if matrix is None else tuple(tuple(row) for row in matrix),
            )
        }
    )


def _exactly(sock: socket.socket, count: int) -> bytearray | None:
    data = bytearray(count)
    view = memoryview(data)
    while len(view):
        got = sock.recv_into(view)
        if got == 0:
            return None
        view = view[got:]
    return data
