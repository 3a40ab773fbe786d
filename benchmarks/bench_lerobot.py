"""``teleop export NAME.lerobot`` opened by lerobot 0.4.4 itself, in an environment of its own (some gigabytes).

The dataset's frames are read through LeRobotDataset: depth is compared bit for bit with the recording.
TELEOP_LEROBOT_ENV names an environment that is there already.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from teleop.recording import McapSource

VERSION = "0.4.4"
_RECORDING = Path("recordings/greenhouse_demo.mcap")
_FOLDER = Path("build/lerobot")
_SECONDS = 4.0
_READ = """
import json, sys
import numpy as np
from importlib.metadata import version
from lerobot.datasets.lerobot_dataset import LeRobotDataset
data = LeRobotDataset("local/greenhouse", root=sys.argv[1], video_backend="pyav")
depth, color = [], []
for i in range(len(data)):
    item = data[i]
    depth.append(np.asarray(item["observation.images.depth"]).squeeze().view(np.uint16))
    if i % 10 == 0:
        color.append(np.asarray(item["observation.images.color"]))
np.savez(sys.argv[2], depth=np.array(depth), color=np.array(color))
print(json.dumps({"version": version("lerobot"), "frames": len(data), "episodes": data.num_episodes, "fps": data.fps,
                  "task": item["task"], "action": list(item["action"].shape), "keys": sorted(item),
                  "normalised": sorted(data.meta.stats)}))
"""


def main() -> None:
    """Export a few seconds, open them there, compare, print."""
    python = _environment()
    _FOLDER.mkdir(parents=True, exist_ok=True)
    session, output, read = _FOLDER / "session.mcap", _FOLDER / "session.lerobot", _FOLDER / "read.npz"
    teleop = str(Path(sys.executable).with_name("teleop"))
    piece = _FOLDER / "piece.mcap"
    for command in (
        ("convert", _RECORDING, piece, "--force", "--from", "20", "--seconds", str(_SECONDS)),
        ("record", piece, session, "--engage", "--force"),
        ("export", session, output, "--force"),
    ):
        subprocess.run([teleop, *map(str, command)], check=True)
    ran = subprocess.run(
        [str(python), "-c", _READ, str(output), str(read)],
        check=True,
        capture_output=True,
        text=True,
        env=os.environ | {"HF_HUB_OFFLINE": "1"},
    )
    found = json.loads(ran.stdout.splitlines()[-1])
    source = McapSource(session)
    frames = list(source.frames())
    source.close()
    with np.load(read) as arrays:
        depth, color = arrays["depth"], arrays["color"]
    equal = sum(np.array_equal(a, b.depth_mm) for a, b in zip(depth, frames, strict=True))
    shown = [np.moveaxis(picture, 0, 2) * 255.0 for picture in color]
    pairs = zip(shown, frames[::10], strict=True)
    off = max(float(np.abs(a - b.color_rgb.astype(np.float64)).mean()) for a, b in pairs if b.color_rgb is not None)
    print(f"lerobot {found['version']}: {found['frames']} frames in {found['episodes']} episode(s), {found['fps']} fps")
    print(f"task '{found['task']}', action {found['action']}, statistics of {len(found['normalised'])} features")
    print(f"keys: {', '.join(found['keys'])}")
    print(f"depth bit-equal in {equal} of {len(frames)} frames; colour off by {off:.1f} of 255 on average (film)")
    if equal != len(frames):
        raise SystemExit("bench: depth differs")


def _environment() -> Path:
    """Python of an environment with lerobot, made at the first call."""
    folder = Path(os.environ.get("TELEOP_LEROBOT_ENV", _FOLDER / "env"))
    python = folder / "bin" / "python"
    if not python.exists():
        print(f"making {folder} with lerobot=={VERSION} (several gigabytes, minutes)", flush=True)
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "--quiet", f"lerobot=={VERSION}"], check=True)
    return python


if __name__ == "__main__":
    main()
