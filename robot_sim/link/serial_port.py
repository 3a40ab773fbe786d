"""Lines over a serial port."""

from __future__ import annotations

import time

import serial

from robot_sim.errors import RobotError
from robot_sim.link.servo_protocol import LONGEST_LINE


class SerialLines:
    """A serial port that sends lines and waits for lines; damaged bytes are the reader's matter."""

    def __init__(self, path: str, baud: int) -> None:
        """Open the port. Raises RobotError with the next step when it cannot be opened."""
        try:
            self._port = serial.Serial(path, baud, timeout=0.0, write_timeout=0.2, exclusive=True)
        except (serial.SerialException, ValueError) as error:
            raise RobotError(
                f"cannot open the serial port {path}: {error}; check the path ('ls /dev/tty*') and that you are in "
                "the group 'dialout'"
            ) from None
        self._waiting = bytearray()

    def send(self, line: bytes) -> bool:
        """Whether the line went out."""
        try:
            self._port.write(line)
        except serial.SerialException:
            return False
        return True

    def receive(self, until_s: float) -> bytes | None:
        """The next line, or None when ``until_s`` (time.monotonic) is past or the port is gone."""
        while True:
            line, end, rest = bytes(self._waiting).partition(b"\n")
            if end:
                self._waiting = bytearray(rest)
                return line + end
            # a line that lost its end must not hold up all that follow
            if len(self._waiting) > LONGEST_LINE:
                self._waiting.clear()
            left_s = until_s - time.monotonic()
            if left_s <= 0.0:
                return None
            try:
                self._port.timeout = left_s
                got = self._port.read(1)
                self._waiting += got + self._port.read(self._port.in_waiting)
            except (serial.SerialException, OSError):
                return None

    def close(self) -> None:
        """Free the port."""
        self._port.close()
