"""The checks of ``teleop doctor`` about serving: settings, tokens, room for recordings."""

from __future__ import annotations

import shutil

from server.access.tokens import load_tokens
from server.cli.check import Check, Status
from server.errors import SettingsError
from server.settings import Settings, load_settings


def service() -> list[Check]:
    """Everything the server needs beside the basics, with the settings of the environment."""
    try:
        settings = load_settings()
    except SettingsError as error:
        return [Check("settings", Status.FAILED, str(error), "correct the TELEOP_* variable")]
    return [Check("settings", Status.OK, "legal"), tokens_check(settings), library_check(settings)]


def tokens_check(settings: Settings) -> Check:
    """The file with the digests; it is not made here, because tokens are shown once."""
    path = settings.access.file
    if not path.exists():
        return Check("tokens", Status.MISSING, "none yet", "the first 'teleop serve' makes them and shows them once")
    try:
        load_tokens(path)
    except SettingsError as error:
        return Check("tokens", Status.FAILED, str(error), "make new ones with 'teleop serve --new-tokens'")
    return Check("tokens", Status.OK, f"kept as digests in {path}")


def library_check(settings: Settings) -> Check:
    """Whether recordings can be written, and how much room there is."""
    folder = settings.library
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent  # made with the first recording
    try:
        probe = folder / ".teleop-doctor"
        probe.touch()
        probe.unlink()
    except OSError as error:
        found = f"{settings.library}: {error.strerror}"
        return Check("library", Status.FAILED, found, "choose another folder with TELEOP_LIBRARY")
    free_mb = shutil.disk_usage(folder).free // 1_000_000
    if free_mb < settings.engine.min_disk_mb:
        return Check("library", Status.MISSING, f"only {free_mb} MB left", "delete recordings, or use TELEOP_LIBRARY")
    return Check("library", Status.OK, f"{settings.library}, {free_mb / 1000:.0f} GB free")
