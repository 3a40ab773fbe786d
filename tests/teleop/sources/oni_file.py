"""A minimal writer of .oni files (version 1.0.1), for the tests of the driver that plays them.

Records are ``NIR\\0``, type, node, bytes of header and fields, bytes of payload, position of what they replace.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

_NODE_ADDED, _INT, _GENERAL, _REMOVED, _DATA_BEGIN, _READY, _DATA, _END, _SEEK_TABLE = (
    0x0D,
    0x03,
    0x06,
    0x07,
    0x08,
    0x09,
    0x0A,
    0x0B,
    0x0E,
)
_DEPTH_TYPE = 2
_DEPTH_1_MM = 100
FOV_RAD = (1.0, 0.8)


def _record(kind: int, node: int, fields: bytes = b"", payload: bytes = b"", undo: int = 0) -> bytes:
    return struct.pack("<4sIIIIQ", b"NIR\0", kind, node, 28 + len(fields), len(payload), undo) + fields + payload


def _text(text: str) -> bytes:
    data = text.encode() + b"\0"
    return struct.pack("<I", len(data)) + data


def _int(name: str, value: int) -> bytes:
    return _record(_INT, 1, _text(name) + struct.pack("<IQ", 8, value))


def _general(name: str, data: bytes) -> bytes:
    return _record(_GENERAL, 1, _text(name) + struct.pack("<I", len(data)) + data)


def _node(count: int, last_us: int, seek_table: int) -> bytes:
    fields = _text("Depth") + struct.pack("<I4sIQQQ", _DEPTH_TYPE, b"NONE", count, 0, last_us, seek_table)
    return _record(_NODE_ADDED, 1, fields)


def write_oni(path: Path, images: list[np.ndarray], period_us: int = 33_000, mirrored: bool = False) -> None:
    """Depth images (H, W) uint16 in millimetres, uncompressed."""
    height, width = images[0].shape
    last_us = (len(images) - 1) * period_us
    mode = struct.pack("<III", width, height, 30)
    head = struct.pack("<4sBBHIQI", b"NI10", 1, 0, 1, 0, last_us, 1)
    node_bytes = len(_node(0, 0, 0))
    body = b"".join(
        (
            _int("oniRequiredFrameSize", width * height * 2),
            _int("xnIsGenerating", 1),
            _int("xnDeviceMaxDepth", 10000),
            _int("xnMirror", int(mirrored)),
            _int("xnSupportedMapOutputModesCount", 1),
            _general("xnSupportedMapOutputModes", mode),
            _general("xnMapOutputMode", mode),
            _general("xnFOV", struct.pack("<dd", *FOV_RAD)),
            _general("xnCropping", struct.pack("<IHHHH", 0, 0, 0, width, height)),
            _int("xnPixelFormat", 4),
            _int("oniPixelFormat", _DEPTH_1_MM),
            _record(_READY, 1),
            _record(_DATA_BEGIN, 1, struct.pack("<IQ", len(images), last_us)),
        )
    )
    start = len(head) + node_bytes
    seek = [struct.pack("<QIQ", 0, 0, 0)]
    undo = 0
    for number, image in enumerate(images):
        position = start + len(body)
        stamp = number * period_us
        fields = struct.pack("<QI", stamp, number + 1)
        body += _record(_DATA, 1, fields, image.astype("<u2").tobytes(), undo)
        seek.append(struct.pack("<QIQ", stamp, 0, position))
        undo = position
    body += _record(_REMOVED, 1, undo=len(head))
    table = start + len(body)
    body += _record(_SEEK_TABLE, 1, b"", b"".join(seek))
    body += _record(_END, 0)
    path.write_bytes(head + _node(len(images), last_us, table) + body)
