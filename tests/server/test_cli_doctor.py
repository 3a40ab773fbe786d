"""``teleop doctor``: what a probe means, and the command itself."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest
from cli_process import teleop, write_recording

from server.cli import checks
from server.cli.checks import Status, sensor_check
from server.cli.try_source import judged, try_source
from teleop.sources.probe import Probe
from teleop.sources.statistics import FrameCounts
from teleop.sources.usb import SENSOR_USB, SensorUsb, has_udev_rule, plugged_in


def test_the_command_lists_every_source_and_its_code_follows_the_basics() -> None:
    with socket.create_server(("127.0.0.1", 0)) as busy:
        port = busy.getsockname()[1]
        result = teleop("doctor", "--json", "--port", port, timeout_s=120)
    assert "Traceback" not in result.stderr
    found = {check["name"]: check for check in json.loads(result.stdout)}
    assert set(found) >= {"Python", "body model", "bundled recording", "console", "groups"}
    assert set(found) >= {"freenect:", "openni2:", "realsense:", "orbbec:"}
    assert found["Python"]["status"] == "ok"
    assert found[f"port {port}"]["status"] == "missing"
    assert "--port" in found[f"port {port}"]["next_step"]
    failed = [check for check in found.values() if check["status"] == "failed"]
    assert result.returncode == (1 if failed else 0)
    for check in found.values():
        assert check["status"] == "ok" or check["next_step"], check


def test_the_table_has_the_next_steps() -> None:
    result = teleop("doctor", "--port", 1 + 2**15, timeout_s=120)
    assert result.returncode in (0, 1)
    assert "next step" in result.stdout and "freenect:" in result.stdout


@pytest.fixture
def usb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A bus and a rules folder of our own, with a Kinect v1 camera on the bus."""
    device = tmp_path / "bus" / "1-1"
    device.mkdir(parents=True)
    (device / "idVendor").write_text("045E\n")
    (device / "idProduct").write_text("02ae\n")
    (tmp_path / "bus" / "usb1").mkdir()
    (tmp_path / "rules").mkdir()
    monkeypatch.setattr(checks, "plugged_in", lambda sensor: plugged_in(sensor, tmp_path / "bus"))
    monkeypatch.setattr(checks, "has_udev_rule", lambda sensor: has_udev_rule(sensor, (tmp_path / "rules",)))
    return tmp_path


def test_what_a_probe_means(usb: Path) -> None:
    absent = sensor_check("freenect", Probe(None, (), "libfreenect.so.0.5 is not installed"))
    assert absent.status is Status.MISSING and "apt install libfreenect0.5" in absent.next_step
    working = sensor_check("freenect", Probe("libfreenect", ("Kinect v1, freenect:0",)))
    assert working.status is Status.OK and "freenect:0" in working.found

    forbidden = sensor_check("freenect", Probe("libfreenect"))
    assert "cannot be opened" in forbidden.found and "no udev rules" in forbidden.found
    assert "udev rules come with" in forbidden.next_step
    (usb / "rules" / "60-kinect.rules").write_text('ATTR{idVendor}=="045e", MODE="0666"')
    assert "log in again" in sensor_check("freenect", Probe("libfreenect")).next_step

    unplugged = sensor_check("orbbec", Probe("pyorbbecsdk2"))
    assert "no device" in unplugged.found and "plug" in unplugged.next_step


def test_a_source_is_tried(tmp_path: Path) -> None:
    good = try_source(str(write_recording(tmp_path / "a.mcap", 40)))
    assert good.status is Status.OK
    assert "40 frames at 30.0/s by their stamps, 0 missing" in good.found and "with colour" in good.found
    absent = try_source(str(tmp_path / "none.mcap"))
    assert absent.status is Status.MISSING and "no recording" in absent.found and absent.next_step


@pytest.mark.parametrize(
    ("counts", "step"),
    [
        (FrameCounts(frames=0), "cable"),
        (FrameCounts(frames=90, lost=9, rate_hz=30.0, valid=0.8), "port of its own"),
        (FrameCounts(frames=90, rate_hz=30.0, valid=0.1), "sunlight"),
        (FrameCounts(frames=90, rate_hz=9.0, valid=0.8), "slow"),
    ],
)
def test_what_the_figures_of_a_sensor_mean(counts: FrameCounts, step: str) -> None:
    check = judged("freenect:0", counts, live=True)
    assert check.status is Status.MISSING and step in check.next_step


def test_the_bus_is_read_by_vendor_and_product(usb: Path) -> None:
    assert plugged_in(SENSOR_USB["freenect"], usb / "bus") == 1
    assert plugged_in(SensorUsb("045e"), usb / "bus") == 1
    assert plugged_in(SensorUsb("045e", frozenset({"0001"})), usb / "bus") == 0
    assert plugged_in(SENSOR_USB["orbbec"], usb / "bus") == 0
    assert plugged_in(SENSOR_USB["orbbec"], usb / "nowhere") == 0
