"""Reading the settings again while the server runs: what can change does, the rest is named."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, Field

from server.settings import Settings

if TYPE_CHECKING:
    from server.engine.engine import Engine

LIVE = "teleop"
"""The only part that can change while the server runs; the rest is read at its start."""
Read = Callable[[], Settings]


class Reloaded(BaseModel):
    """What reading the settings again has changed."""

    changed: list[str] = Field(description="settings that are in force now", examples=[["teleop.intent.zones.l1_m"]])
    needs_restart: list[str] = Field(description="settings that differ, but count from the next start on only")


def reload(engine: Engine, read: Read) -> Future[Reloaded]:
    """Take over what the file, the environment and the flags say now; changes made over the API since are undone.

    Raises SettingsError, and changes nothing, when the settings are refused.
    """
    fresh = read()
    done: Future[Reloaded] = Future()
    told = Reloaded(changed=[], needs_restart=[])

    def change(now: Settings) -> Settings:
        for name in _differences(now.model_dump(), fresh.model_dump()):
            (told.changed if name.startswith(f"{LIVE}.") else told.needs_restart).append(name)
        return now.model_copy(update={LIVE: getattr(fresh, LIVE)})

    def finished(future: Future[Settings]) -> None:
        error = future.exception()
        if error is not None:
            done.set_exception(error)
        else:
            done.set_result(told)

    engine.configure(change).add_done_callback(finished)
    return done


def _differences(old: Mapping[str, Any], new: Mapping[str, Any], path: str = "") -> Iterator[str]:
    for key, value in new.items():
        before = old.get(key)
        if isinstance(value, Mapping) and isinstance(before, Mapping):
            yield from _differences(before, value, f"{path}{key}.")
        elif before != value:
            yield f"{path}{key}"
