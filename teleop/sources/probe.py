"""Is a sensor's library there, and does it find a device? Asked in a child process: C libraries may crash or exit.

``python -m teleop.sources.probe KIND`` prints one JSON object.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Final

from teleop.errors import SourceError

TIMEOUT_S: Final = 20.0


@dataclass(frozen=True, slots=True)
class Probe:
    """What the child found. library: its name and version, None when it cannot be used; problem says why not."""

    library: str | None
    devices: tuple[str, ...] = ()
    problem: str = ""


def probe(kind: str, timeout_s: float = TIMEOUT_S) -> Probe:
    """Probe one kind of sensor in a child process; a crash or a hang is a problem to report, not an exception."""
    command = [sys.executable, "-m", "teleop.sources.probe", kind]
    try:
        child = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, check=False)
    except subprocess.TimeoutExpired:
        return Probe(None, (), f"does not answer within {timeout_s:.0f} s")
    lines = [line for line in child.stdout.splitlines() if line.startswith("{")]
    if not lines:
        last = child.stderr.strip().splitlines()
        return Probe(None, (), f"stopped with code {child.returncode}" + (f": {last[-1]}" if last else ""))
    found = json.loads(lines[-1])
    return Probe(found["library"], tuple(found["devices"]), found["problem"])


def _freenect() -> Probe:
    from teleop.sources.freenect_api import LIBRARY, device_count

    count = device_count()
    return Probe(LIBRARY, tuple(f"Kinect v1, freenect:{i}" for i in range(count)))


def _openni2() -> Probe:
    from teleop.sources.openni2 import device_uris, start_openni2

    api: Any = start_openni2()
    v = api.get_version()
    uris = tuple(f"openni2:{uri}" for uri in device_uris(api))
    return Probe(f"libOpenNI2 {v.major}.{v.minor}.{v.maintenance}, openni {_version('openni')}", uris)


def _realsense() -> Probe:
    from teleop.sources.live import import_driver

    rs: Any = import_driver("pyrealsense2", "pyrealsense2")
    info = rs.camera_info
    devices = tuple(
        f"{d.get_info(info.name)}, realsense:{d.get_info(info.serial_number)}" for d in rs.context().query_devices()
    )
    return Probe(f"pyrealsense2 {_version('pyrealsense2')}", devices)


def _orbbec() -> Probe:
    from teleop.sources.live import import_driver

    ob: Any = import_driver("pyorbbecsdk", "pyorbbecsdk2")
    ob.Context.set_logger_level(ob.OBLogLevel.NONE)
    found = ob.Context().query_devices()
    devices = tuple(
        f"{found.get_device_name_by_index(i)}, orbbec:{found.get_device_serial_number_by_index(i)}"
        for i in range(found.get_count())
    )
    return Probe(f"pyorbbecsdk2 {_version('pyorbbecsdk2')}", devices)


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "of unknown version"


KINDS: Final[dict[str, Callable[[], Probe]]] = {
    "freenect": _freenect,
    "openni2": _openni2,
    "realsense": _realsense,
    "orbbec": _orbbec,
}


def main() -> None:
    """Child process: probe the kind named on the command line."""
    try:
        result = KINDS[sys.argv[1]]()
    except (SourceError, RuntimeError) as error:
        result = Probe(None, (), " ".join(str(error).split()))
    # Written at once: a library may crash the process on its way out.
    print("\n" + json.dumps(asdict(result)), flush=True)


if __name__ == "__main__":
    main()
