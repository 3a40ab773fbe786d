"""The 16-byte header in front of every picture on the stream: little-endian, then JPEG (body parts: PNG) bytes."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntEnum

_HEADER = struct.Struct("<2sBBHHII")
MAGIC = b"GT"


class ImageKind(IntEnum):
    """Which picture follows the header."""

    DEPTH = 1
    COLOR = 2
    HEAD = 3
    PARTS = 4


@dataclass(frozen=True, slots=True)
class ImagePacket:
    """One picture. width and height in pixels; seq is the state it belongs to."""

    kind: ImageKind
    width: int
    height: int
    seq: int
    jpeg: bytes

    def to_bytes(self) -> bytes:
        """Header and JPEG as one binary message."""
        return _HEADER.pack(MAGIC, self.kind, 0, self.width, self.height, self.seq & 0xFFFFFFFF, 0) + self.jpeg

    @classmethod
    def from_bytes(cls, data: bytes) -> ImagePacket:
        """Inverse of :meth:`to_bytes`. Raises ValueError when the header is not one of ours."""
        if len(data) < _HEADER.size:
            raise ValueError(f"picture message of {len(data)} bytes is shorter than its {_HEADER.size}-byte header")
        magic, kind, _, width, height, seq, _ = _HEADER.unpack_from(data)
        if magic != MAGIC:
            raise ValueError(f"picture message starts with {magic!r}, expected {MAGIC!r}")
        return cls(ImageKind(kind), width, height, seq, data[_HEADER.size :])
