"""Pictures for the clients: colour-mapped depth, colour, head camera; encoded once for all, off the engine's thread."""

from __future__ import annotations

import threading
from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt

from server.engine.parts_picture import parts_packet
from server.images_wire import ImageKind, ImagePacket
from server.settings import StreamConfig
from teleop.frames import DepthFrame, DepthImage
from teleop.skeleton import BodyParts

Picture = npt.NDArray[np.uint8]


def depth_picture(depth_mm: DepthImage, config: StreamConfig) -> Picture:
    """Near is warm, far is cold, no reading is black: (h, w, 3) BGR of the configured width."""
    height, width = depth_mm.shape
    step = max(1, round(width / config.image_width_px))
    small = depth_mm[::step, ::step]
    near, far = config.depth_near_m * 1000.0, config.depth_far_m * 1000.0
    scaled = np.clip((far - small.astype(np.float32)) * (255.0 / (far - near)), 0.0, 255.0).astype(np.uint8)
    picture = cv2.applyColorMap(scaled, cv2.COLORMAP_TURBO)
    picture[small == 0] = 0
    return _resized(np.asarray(picture, dtype=np.uint8), config.image_width_px, width, height)


def color_picture(color_rgb: npt.NDArray[np.uint8], config: StreamConfig) -> Picture:
    """The colour image at the configured width, BGR."""
    height, width = color_rgb.shape[:2]
    small = _resized(color_rgb, config.image_width_px, width, height)
    return np.ascontiguousarray(small[:, :, ::-1])


def encoded(kind: ImageKind, picture: Picture, seq: int, quality: int) -> ImagePacket:
    """JPEG of a BGR picture."""
    ok, data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not ok:
        raise ValueError(f"cannot encode a picture of shape {picture.shape}")
    return ImagePacket(kind, picture.shape[1], picture.shape[0], seq, data.tobytes())


def _resized(picture: Picture, width_px: int, width: int, height: int) -> Picture:
    size = (width_px, max(1, round(height * width_px / width)))
    if (picture.shape[1], picture.shape[0]) == size:
        return picture
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


class Previewer(threading.Thread):
    """Takes the newest frame, encodes what somebody looks at, hands the packets on."""

    def __init__(self, config: StreamConfig, deliver: Callable[[ImagePacket], None]) -> None:
        super().__init__(name="preview", daemon=True)
        self._config = config
        self._deliver = deliver
        self._work = threading.Condition()
        self._frame: tuple[DepthFrame, BodyParts | None, int, frozenset[ImageKind]] | None = None
        self._stopping = False

    def offer(self, frame: DepthFrame, parts: BodyParts | None, seq: int, wanted: frozenset[ImageKind]) -> None:
        """Leave a frame to be shown, with the forest's answer for it; one not yet begun is replaced."""
        with self._work:
            self._frame = (frame, parts, seq, wanted)
            self._work.notify()

    def stop(self) -> None:
        """End the thread."""
        with self._work:
            self._stopping = True
            self._work.notify()
        if self.is_alive():
            self.join(2.0)

    def run(self) -> None:
        """Encode until stopped."""
        while True:
            with self._work:
                self._work.wait_for(lambda: self._frame is not None or self._stopping)
                if self._stopping or self._frame is None:
                    return
                (frame, parts, seq, wanted), self._frame = self._frame, None
            quality = self._config.jpeg_quality
            if ImageKind.DEPTH in wanted:
                self._deliver(encoded(ImageKind.DEPTH, depth_picture(frame.depth_mm, self._config), seq, quality))
            if ImageKind.COLOR in wanted and frame.color_rgb is not None:
                self._deliver(encoded(ImageKind.COLOR, color_picture(frame.color_rgb, self._config), seq, quality))
            if ImageKind.PARTS in wanted:
                self._deliver(parts_packet(parts, frame.camera.depth.width, frame.camera.depth.height, seq))
