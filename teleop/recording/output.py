"""The file under the MCAP writer: remembers a failed write, which the writer's log calls do not report."""

from __future__ import annotations

import fcntl
import os
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from teleop.errors import RecordingError


class OutputFile:
    """A new binary file that keeps its first error (disk full, pulled drive) instead of losing it.

    It is locked while it is open, so that nobody repairs what is only unfinished; a killed process loses its lock.
    """

    def __init__(self, path: Path) -> None:
        """Create ``path``. Raises RecordingError when it exists already or cannot be created."""
        try:
            self._file: BinaryIO = path.open("xb")
        except FileExistsError:
            raise RecordingError(f"{path} exists already; remove it or choose another name") from None
        except OSError as error:
            raise RecordingError(f"cannot create {path}: {error.strerror or error}") from None
        self.error: OSError | None = None
        # not every file system can lock, and a recording without its lock is better than none
        with suppress(OSError):
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def write(self, data: bytes | bytearray) -> int:
        """Append bytes at the current position."""
        try:
            return self._file.write(data)
        except OSError as error:
            self.error = self.error or error
            raise

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move the position; writes that were held back happen here."""
        if (offset, whence) == (0, os.SEEK_CUR):
            return self._file.tell()
        try:
            return self._file.seek(offset, whence)
        except OSError as error:
            self.error = self.error or error
            raise

    def flush(self) -> None:
        """Hand everything to the operating system, so that a killed process loses nothing of it."""
        try:
            self._file.flush()
        except OSError as error:
            self.error = self.error or error
            raise

    def close(self) -> None:
        """Close the file; an error of the last write is kept in ``error``."""
        try:
            self._file.close()
        except OSError as error:
            self.error = self.error or error


def is_being_written(path: Path) -> bool:
    """Whether some process has the recording open for writing."""
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
