"""GET and PATCH /config: the one configuration tree."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body

from server.api.deps import EngineDep, ReadDep, done
from server.api.problems import documented
from server.errors import Refused
from server.reload import LIVE, Reloaded, reload
from server.settings import Settings, changed

router = APIRouter(tags=["configuration"])


@router.get("/config")
def read_config(engine: EngineDep) -> Settings:
    """Every setting in force."""
    return engine.settings


@router.get("/config/schema")
def config_schema() -> dict[str, Any]:
    """JSON schema of the tree: ranges, units, sources; a form can be made from it."""
    return Settings.model_json_schema()


@router.patch("/config", responses=documented(409, 422))
async def change_config(
    engine: EngineDep,
    patch: Annotated[
        dict[str, Any],
        Body(examples=[{"teleop": {"intent": {"mapping": {"mapping": "direction"}}}}], description="a partial tree"),
    ],
) -> Settings:
    """Lay a partial tree over the settings; all of it or, when anything is refused, nothing. Arms hold meanwhile."""
    return await done(engine.configure(lambda now: _laid_over(now, patch)))


@router.post("/config/reload", responses=documented(422, 503))
async def reload_config(engine: EngineDep, read: ReadDep) -> Reloaded:
    """Read file, environment and flags again, as SIGHUP does; what was changed over the API since is undone."""
    return await done(reload(engine, read))


def _laid_over(now: Settings, patch: dict[str, Any]) -> Settings:
    settings = changed(now, patch)
    fixed = [key for key in patch if key != LIVE and getattr(settings, key) != getattr(now, key)]
    if fixed:
        raise Refused(
            409, f"{', '.join(fixed)}: read at the start only; restart 'teleop serve' with a changed --config"
        )
    return settings
