"""Operator profiles: list, read, write, remove, and choose who drives."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body
from pydantic import BaseModel, Field, ValidationError

from server.api.deps import EngineDep, done
from server.api.problems import documented
from server.engine.engine import Engine
from server.errors import Refused
from server.refusals import explain
from server.settings import Settings, with_operator
from teleop.config import OperatorConfig, TeleopConfig
from teleop.profiles import ProfileError, ProfileStore

router = APIRouter(prefix="/operators", tags=["operators"])


class Operators(BaseModel):
    """Who is known, and who is chosen."""

    names: list[str]
    chosen: str = Field(description="empty: nobody is chosen")


class Choice(BaseModel):
    """Who drives."""

    name: str = Field(default="", max_length=40, description="an operator's name; empty chooses nobody")


def _store(engine: Engine) -> ProfileStore:
    return ProfileStore(engine.settings.operators)


@router.get("")
def list_operators(engine: EngineDep) -> Operators:
    """Names of all profiles, and the chosen one."""
    return Operators(names=_store(engine).names(), chosen=engine.settings.teleop.operator.name)


@router.post("/chosen", responses=documented(404, 409, 422))
async def choose_operator(engine: EngineDep, choice: Annotated[Choice, Body()]) -> Operators:
    """Lay somebody's profile over the settings; perception and intent begin anew, arms hold meanwhile."""

    def change(now: Settings) -> Settings:
        try:
            return with_operator(now, choice.name)
        except ProfileError as error:
            raise Refused(404, str(error)) from error

    await done(engine.configure(change))
    return list_operators(engine)


@router.get("/{name}", responses=documented(404, 422))
def read_operator(engine: EngineDep, name: str) -> OperatorConfig:
    """One profile."""
    try:
        return _store(engine).load(name)
    except ProfileError as error:
        raise Refused(404, str(error)) from error


@router.put("/{name}", responses=documented(422))
def write_operator(engine: EngineDep, name: str, profile: OperatorConfig) -> OperatorConfig:
    """Make or replace a profile; the running one changes when it is chosen again."""
    profile = profile.model_copy(update={"name": name})
    try:
        TeleopConfig.model_validate({"operator": profile.model_dump(mode="python")})
        _store(engine).save(profile)
    except ValidationError as error:
        raise Refused(422, explain(error, TeleopConfig)) from error
    except ProfileError as error:
        raise Refused(422, str(error)) from error
    return profile


@router.delete("/{name}", status_code=204, responses=documented(404, 409))
def remove_operator(engine: EngineDep, name: str) -> None:
    """Forget somebody who is not driving."""
    if engine.settings.teleop.operator.name.casefold() == name.casefold():
        raise Refused(409, f"'{name}' is chosen; choose somebody else, or nobody, first")
    try:
        _store(engine).remove(name)
    except ProfileError as error:
        raise Refused(404, str(error)) from error
