"""Records a software device of librealsense: ``python realsense_recording.py FILE.db3 FRAMES``.

Run in a process of its own: the library may crash on its way out.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np

WIDTH, HEIGHT = 640, 480
PERIOD_MS = 33.0


def depth_mm(number: int) -> np.ndarray:
    ramp = np.arange(WIDTH * HEIGHT, dtype=np.uint32).reshape(HEIGHT, WIDTH)
    return (500 + (ramp + 997 * number) % 4000).astype(np.uint16)


def color_rgb(number: int) -> np.ndarray:
    image = np.full((HEIGHT, WIDTH, 3), (10 * number, 120, 200), np.uint8)
    image[: HEIGHT // 2, :, 2] = 40
    return image


def intrinsics(rs: Any) -> Any:
    k = rs.intrinsics()
    k.width, k.height, k.fx, k.fy, k.ppx, k.ppy = WIDTH, HEIGHT, 600.0, 601.0, 319.5, 239.5
    k.model, k.coeffs = rs.distortion.none, [0.0] * 5
    return k


def video_stream(rs: Any, kind: Any, uid: int, bytes_per_pixel: int, pixel_format: Any) -> Any:
    stream = rs.video_stream()
    stream.type, stream.index, stream.uid, stream.fps = kind, 0, uid, 30
    stream.width, stream.height, stream.bpp, stream.fmt = WIDTH, HEIGHT, bytes_per_pixel, pixel_format
    stream.intrinsics = intrinsics(rs)
    return stream


def record(path: str, count: int) -> None:
    import pyrealsense2 as rs

    device = rs.software_device()
    depth_sensor, color_sensor = device.add_sensor("Depth"), device.add_sensor("Color")
    depth = depth_sensor.add_video_stream(video_stream(rs, rs.stream.depth, 0, 2, rs.format.z16))
    color = color_sensor.add_video_stream(video_stream(rs, rs.stream.color, 1, 3, rs.format.rgb8))
    depth_sensor.add_read_only_option(rs.option.depth_units, 0.001)
    still = rs.extrinsics()
    still.rotation, still.translation = [1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 0, 0]
    depth.register_extrinsics_to(color, still)
    device.create_matcher(rs.matchers.default)
    recorder = rs.recorder(path, device)
    sensors = {s.get_info(rs.camera_info.name): s for s in recorder.query_sensors()}
    queue = rs.frame_queue(4 * count)
    for sensor in sensors.values():
        sensor.open(sensor.get_stream_profiles()[0])
        sensor.start(queue)
    kept = []
    for number in range(count):
        for sensor, profile, image in (
            (depth_sensor, depth, depth_mm(number)),
            (color_sensor, color, color_rgb(number)),
        ):
            frame = rs.software_video_frame()
            kept.append(image)
            frame.pixels, frame.stride, frame.bpp = image, image.strides[0], image.strides[1]
            frame.timestamp, frame.domain = 1000 + PERIOD_MS * number, rs.timestamp_domain.hardware_clock
            frame.frame_number, frame.profile = number, profile.as_video_stream_profile()
            sensor.on_video_frame(frame)
        time.sleep(0.02)
    time.sleep(0.3)
    for sensor in sensors.values():
        sensor.stop()
        sensor.close()


if __name__ == "__main__":
    record(sys.argv[1], int(sys.argv[2]))
    print("RECORDED", flush=True)
