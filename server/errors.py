"""Errors of the edge: what a user or a client got wrong, in one line."""

from __future__ import annotations

from teleop.errors import TeleopError


class ServerError(TeleopError):
    """The server cannot start or go on; the command line prints it and exits 1."""


class SettingsError(ServerError):
    """A setting that does not exist or is out of its range."""


class Refused(ServerError):
    """A request that cannot be carried out now. status: the HTTP status. code: for programs, where the status leaves
    it open which rule was broken."""

    def __init__(self, status: int, detail: str, code: str | None = None) -> None:
        super().__init__(detail)
        self.status = status
        self.detail = detail
        self.code = code
