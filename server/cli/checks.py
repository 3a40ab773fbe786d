"""The checks of ``teleop doctor``: the basics that must work, then every kind of sensor."""

from __future__ import annotations

import os
import platform
import socket
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

from server.cli.check import Check, Status
from server.settings import bundled_recordings
from teleop.errors import TeleopError
from teleop.sources.probe import KINDS, Probe, probe
from teleop.sources.usb import SENSOR_USB, has_udev_rule, plugged_in

ROOT: Final = Path(__file__).resolve().parents[2]
CONSOLE: Final = ROOT / "server" / "console" / "index.html"
BUNDLED: Final = bundled_recordings() / "greenhouse_demo.mcap"
GROUPS: Final = ("plugdev", "video")

INSTALL: Final = {
    "freenect": "sudo apt install libfreenect0.5",
    "openni2": "sudo apt install libopenni2-0, then .venv/bin/pip install openni",
    "realsense": ".venv/bin/pip install pyrealsense2 (and sudo apt install libusb-1.0-0)",
    "orbbec": ".venv/bin/pip install pyorbbecsdk2",
}
RULES: Final = {
    "freenect": "the udev rules come with libfreenect0.5",
    "openni2": "the udev rules come with libopenni2-0",
    "realsense": "install the udev rules: 99-realsense-libusb.rules of the librealsense project, in /etc/udev/rules.d",
    "orbbec": "install the udev rules: 99-obsensor-libusb.rules of the OrbbecSDK project, in /etc/udev/rules.d",
}


def basics(host: str, port: int) -> list[Check]:
    """What ``make run`` needs."""
    return [_python(), _model(), _recording(), _console(), _port(host, port)]


def sensors() -> list[Check]:
    """Every kind of live source; the probes run side by side, each in its own process."""
    with ThreadPoolExecutor(max_workers=len(KINDS)) as pool:
        probes = dict(zip(KINDS, pool.map(probe, KINDS), strict=True))
    return [sensor_check(kind, found) for kind, found in probes.items()] + [_groups(), *_built_in()]


def sensor_check(kind: str, found: Probe) -> Check:
    """What a probe means, together with the USB bus and the udev rules."""
    name = f"{kind}:"
    if found.library is None:
        return Check(name, Status.MISSING, found.problem, INSTALL[kind])
    if found.devices:
        return Check(name, Status.OK, f"{found.library}; {', '.join(found.devices)}")
    on_bus = plugged_in(SENSOR_USB[kind])
    rule = has_udev_rule(SENSOR_USB[kind])
    rules = "udev rules found" if rule else "no udev rules"
    if on_bus:
        step = "unplug and plug it again, or log in again after a change of groups" if rule else RULES[kind]
        return Check(name, Status.MISSING, f"{found.library}; on the USB bus but cannot be opened; {rules}", step)
    step = "plug the sensor and its power supply in" + ("" if rule else f"; {RULES[kind]}")
    return Check(name, Status.MISSING, f"{found.library}; no device; {rules}", step)


def _python() -> Check:
    text = f"{platform.python_version()}, {platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    if sys.version_info[:2] != (3, 11):
        return Check("Python", Status.FAILED, text, "install Python 3.11 or uv, then run 'make setup' again")
    return Check("Python", Status.OK, text)


def _model() -> Check:
    from teleop.body.model import load_model

    try:
        model = load_model()
    except TeleopError as error:
        return Check("body model", Status.FAILED, str(error), "restore teleop/models, or make one with 'teleop train'")
    return Check("body model", Status.OK, f"{len(model.roots)} trees, {len(model.offsets)} nodes")


def _recording() -> Check:
    from teleop.recording import McapSource

    try:
        source = McapSource(BUNDLED)
    except TeleopError as error:
        return Check("bundled recording", Status.FAILED, str(error), "restore recordings/ from the repository")
    source.close()
    info = source.info
    return Check("bundled recording", Status.OK, f"{info.frame_count} frames, {info.duration_s or 0:.0f} s")


def _console() -> Check:
    if not CONSOLE.is_file():
        return Check("console", Status.FAILED, "not built", "run 'make setup'")
    return Check("console", Status.OK, "built")


def _port(host: str, port: int) -> Check:
    name = f"port {port}"
    try:
        # As the server binds it: a port that has just been closed counts as free.
        with socket.create_server((host, port)):
            return Check(name, Status.OK, f"free on {host}")
    except OSError as error:
        step = "a teleop may be running there; else choose another with 'teleop serve --port'"
        return Check(name, Status.MISSING, f"not free on {host}: {error.strerror or error}", step)


def _groups() -> Check:
    import grp

    if os.geteuid() == 0:
        return Check("groups", Status.OK, "root opens every device")
    ids = {os.getegid(), *os.getgroups()}
    known = {group.gr_name: group.gr_gid for group in grp.getgrall()}
    lacking = [name for name in GROUPS if name in known and known[name] not in ids]
    if lacking:
        step = f"sudo usermod -aG {','.join(lacking)} $USER, then log in again"
        return Check("groups", Status.MISSING, f"not a member of {', '.join(lacking)}", step)
    return Check("groups", Status.OK, "member of those that open sensors")


def _built_in() -> list[Check]:
    return [
        Check(".mcap, RGB-D folder", Status.OK, "need no library"),
        Check("virtual:, push:", Status.OK, "need no library"),
    ]
