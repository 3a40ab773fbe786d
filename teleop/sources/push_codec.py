"""Frames on their way from another machine: bytes and text in, frames out, and the rule of flow. No socket here.

The sender opens with one text message, its camera. Then every frame is one binary message, little endian::

    0  4s  "GTPF"          16  u64  t_ns, the sensor's own stamp
    4  u8  version, 1      24  u16  width        26  u16  height
    5  u8  flags, 0        28  u32  bytes of depth (zstd of uint16 mm, row by row)
    6  u16 reserved, 0     32  u32  bytes of colour (JPEG), 0 for none
    8  u64 running number  36  depth, then colour

Depth is 16 bit, 0 for no reading; colour is registered to depth or as the announced camera says. Stamps must increase.
The receiver answers each frame with the text ``{"type": "ack", "seq": n}``, which answers all frames before it too;
the sender keeps a few frames on the way and drops newer ones meanwhile, so that a slow line costs rate, not delay. A
text ``{"type": "error", "detail": "..."}`` says why the receiver hangs up.
"""

from __future__ import annotations

import json
import struct
from dataclasses import asdict
from typing import Any, Final

import numpy as np
import zstandard

from teleop.errors import FrameError, SourceError
from teleop.frames import Camera, ColorImage, DepthFrame, DepthImage, Intrinsics
from teleop.sources.jpeg import decode_jpeg, encode_jpeg

VERSION: Final = 1
MAGIC: Final = b"GTPF"
_HEADER = struct.Struct("<4sBBHQQHHII")
_MAX_SIDE: Final = 4096
MAX_MESSAGE_BYTES: Final = 64 << 20


def encode_camera(camera: Camera, *, has_color: bool) -> str:
    """The opening message."""
    return json.dumps({"type": "camera", "version": VERSION, "has_color": has_color, "camera": asdict(camera)})


def decode_camera(text: str) -> tuple[Camera, bool]:
    """Camera and whether colour will come. Raises SourceError."""
    message = _object(text)
    if message.get("type") != "camera" or message.get("version") != VERSION:
        raise SourceError(f"push: the first message must announce the camera in version {VERSION}")
    try:
        content = message["camera"]
        color = content.get("color")
        matrix = content.get("T_color_depth")
        camera = Camera(
            depth=_intrinsics(content["depth"]),
            mirrored=content.get("mirrored", False) is True,
            color=None if color is None else _intrinsics(color),
            T_color_depth=None
            if matrix is None
            else tuple(tuple(float(x) for x in row) for row in np.array(matrix, dtype=float).reshape(4, 4)),
        )
    except (KeyError, TypeError, ValueError, AttributeError, FrameError) as error:
        raise SourceError(f"push: the announced camera is not usable: {error}") from None
    return camera, message.get("has_color") is True


def encode_frame(frame: DepthFrame, *, jpeg_quality: int = 85) -> bytes:
    """One binary message."""
    height, width = frame.depth_mm.shape
    depth = zstandard.ZstdCompressor(level=3).compress(np.ascontiguousarray(frame.depth_mm, dtype="<u2").tobytes())
    color = b""
    if frame.color_rgb is not None:
        color = frame.color_jpeg or encode_jpeg(frame.color_rgb, jpeg_quality)
    header = _HEADER.pack(
        MAGIC, VERSION, 0, 0, frame.seq & 0xFFFFFFFFFFFFFFFF, frame.t_ns, width, height, len(depth), len(color)
    )
    return header + depth + color


def decode_frame(message: bytes, camera: Camera) -> DepthFrame:
    """The frame of one binary message. Raises SourceError, whatever the bytes are."""
    if len(message) < _HEADER.size:
        raise SourceError(f"push: a frame has at least {_HEADER.size} bytes, got {len(message)}")
    magic, version, flags, reserved, seq, t_ns, width, height, depth_bytes, color_bytes = _HEADER.unpack_from(message)
    if magic != MAGIC or version != VERSION or flags or reserved:
        raise SourceError(f"push: not a frame of version {VERSION}; use the teleop of the server's version")
    if (width, height) != (camera.depth.width, camera.depth.height):
        raise SourceError(
            f"push: the frame is {width}x{height}, the camera was announced as "
            f"{camera.depth.width}x{camera.depth.height}"
        )
    if len(message) != _HEADER.size + depth_bytes + color_bytes:
        raise SourceError(f"push: the frame's lengths do not add up to its {len(message)} bytes")
    if t_ns >= 1 << 63:
        raise SourceError("push: the time stamp is out of range")
    end = _HEADER.size + depth_bytes
    depth = _depth(message[_HEADER.size : end], width, height)
    if not color_bytes:
        return DepthFrame(t_ns, depth, camera, None, seq)
    jpeg = bytes(message[end:])
    return DepthFrame(t_ns, depth, camera, _color(jpeg), seq, jpeg)


def encode_ack(seq: int) -> str:
    """The receiver's answer to one frame."""
    return json.dumps({"type": "ack", "seq": seq})


def decode_ack(text: str) -> int:
    """The running number that was acknowledged. Raises SourceError, also when the receiver reports an error."""
    message = _object(text)
    if message.get("type") == "error":
        raise SourceError(f"push: the server refuses: {message.get('detail', '')}")
    seq = message.get("seq")
    if message.get("type") != "ack" or not isinstance(seq, int) or isinstance(seq, bool):
        raise SourceError("push: expected an acknowledgement")
    return seq


class PushWindow:
    """The sender's side of the flow: at most ``size`` frames on the way. Counts what was left out.

    Messages arrive in order but may be lost: an answer to a frame answers all before it, and a frame without an
    answer for ``lost_s`` counts as lost, so that a full window opens again. Time comes in as an argument [s].
    """

    def __init__(self, size: int = 8, lost_s: float = 1.0) -> None:
        self.size = size
        self.lost_s = lost_s
        self.dropped = 0
        self._sent_s: dict[int, float] = {}

    def may_send(self, seq: int, now_s: float) -> bool:
        """Whether frame ``seq`` goes out now; if not, it is dropped for good."""
        for old in [s for s, sent_s in self._sent_s.items() if now_s - sent_s > self.lost_s]:
            del self._sent_s[old]
        if len(self._sent_s) >= self.size:
            self.dropped += 1
            return False
        self._sent_s[seq] = now_s
        return True

    @property
    def on_the_way(self) -> int:
        """Frames that have not been answered yet."""
        return len(self._sent_s)

    def acknowledged(self, seq: int) -> None:
        """An answer came."""
        for old in [s for s in self._sent_s if s <= seq]:
            del self._sent_s[old]


def _depth(data: bytes, width: int, height: int) -> DepthImage:
    expected = 2 * width * height
    try:
        # Before decompressing: a few bytes can claim to hold gigabytes.
        if zstandard.get_frame_parameters(data).content_size != expected:
            raise SourceError(f"push: the depth does not hold {width}x{height} pixels")
        raw = zstandard.ZstdDecompressor().decompress(data, max_output_size=expected)
    except zstandard.ZstdError as error:
        raise SourceError(f"push: the depth is damaged: {error}") from None
    if len(raw) != expected:
        raise SourceError(f"push: the depth does not hold {width}x{height} pixels")
    return np.frombuffer(raw, dtype="<u2").reshape(height, width).astype(np.uint16, copy=False)


def _color(data: bytes) -> ColorImage:
    image = decode_jpeg(data)
    if image is None:
        raise SourceError("push: the colour is no JPEG image, damaged or too large")
    return image


def _intrinsics(content: Any) -> Intrinsics:
    numbers = (float(content[name]) for name in ("fx", "fy", "cx", "cy"))
    width, height = int(content["width"]), int(content["height"])
    if max(width, height) > _MAX_SIDE:
        raise ValueError(f"{width}x{height} is larger than {_MAX_SIDE} pixels")
    fx, fy, cx, cy = numbers
    return Intrinsics(fx, fy, cx, cy, width, height)


def _object(text: str) -> dict[str, Any]:
    try:
        message = json.loads(text)
    except ValueError:
        message = None
    if not isinstance(message, dict):
        raise SourceError("push: expected a JSON object")
    return message
