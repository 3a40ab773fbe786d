"""Sensors on the USB bus and the udev rules that let a user open them (Linux)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

RULE_FOLDERS: Final = (Path("/etc/udev/rules.d"), Path("/lib/udev/rules.d"), Path("/usr/lib/udev/rules.d"))
USB_DEVICES: Final = Path("/sys/bus/usb/devices")


@dataclass(frozen=True, slots=True)
class SensorUsb:
    """USB ids of one family of sensors. products: None is every product of the vendor."""

    vendor: str
    products: frozenset[str] | None = None


SENSOR_USB: Final[dict[str, SensorUsb]] = {
    "freenect": SensorUsb("045e", frozenset({"02ae", "02ad", "02b0", "02bf", "02be", "02c2"})),  # Kinect v1
    "openni2": SensorUsb("1d27"),  # PrimeSense, Xtion
    "realsense": SensorUsb("8086", frozenset({"0ad1", "0ad3", "0b07", "0b3a", "0b3d", "0b5b", "0b5c", "0b64"})),
    "orbbec": SensorUsb("2bc5"),
}


def plugged_in(sensor: SensorUsb, devices: Path = USB_DEVICES) -> int:
    """Number of such devices on the bus, whether a library can open them or not."""
    count = 0
    for folder in devices.iterdir() if devices.is_dir() else ():
        vendor, product = (_text(folder / name) for name in ("idVendor", "idProduct"))
        count += vendor == sensor.vendor and (sensor.products is None or product in sensor.products)
    return count


def has_udev_rule(sensor: SensorUsb, folders: tuple[Path, ...] = RULE_FOLDERS) -> bool:
    """Whether some rule names the vendor."""
    rules = (rule for folder in folders if folder.is_dir() for rule in folder.glob("*.rules"))
    return any(f'"{sensor.vendor}"' in _text(rule) for rule in rules)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip().lower()
    except OSError:
        return ""
