"""The OpenAPI document: what FastAPI finds in the routes, and what the gate and the guard add to each of them."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute

from server.access.policy import API, SAFE_METHODS, need
from server.api.problems import MEDIA_TYPE

_PROBLEM = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
_ABOUT = """\
Every refusal is a problem-details object (RFC 9457) that says what is legal and what to do next.

Access: clients on the server's own machine are operators; others log in or send `Authorization: Bearer TOKEN`.
Routes that command the robot need the lease: the first command takes it while it is free (`X-Teleop-Client` names
the client). State, events and pictures come over the websocket `/api/v1/stream`.
"""


def operation_id(route: APIRoute) -> str:
    """The function's own name: what a generated client calls the method."""
    return route.name


def install(app: FastAPI) -> None:
    """Make ``app.openapi()`` tell of roles, lease, limits and their refusals, from the gate's own table."""

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            found = get_openapi(
                title=app.title, version=app.version, summary=app.summary, description=_ABOUT, routes=app.routes
            )
            _complete(found)
            app.openapi_schema = found
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]


def _complete(document: dict[str, Any]) -> None:
    document["components"]["securitySchemes"] = {
        "token": {"type": "http", "scheme": "bearer", "description": "a role's token, shown at the first start"}
    }
    for path, operations in document["paths"].items():
        for verb, operation in operations.items():
            needs = need(verb.upper(), path)
            statuses = {403}  # a foreign host or origin
            if "422" in operation["responses"]:
                statuses.add(422)
            if path.startswith(f"{API}/"):
                statuses |= {401, 422, 429}  # a wrong token or client key counts where none is needed, too
            if needs.role is not None:
                operation["security"] = [{"token": []}, {}]
                operation["x-role"] = needs.role.label
                statuses |= {401, 422, 429}
            if needs.lease:
                operation["x-lease"] = True
                statuses.add(423)
            if needs.limited:
                statuses.add(429)
            if verb.upper() not in SAFE_METHODS:
                statuses.add(413)
            for status in sorted(statuses):
                answer = {"description": HTTPStatus(status).phrase, "content": _PROBLEM}
                operation["responses"].setdefault(str(status), answer)
                if status == 422:  # FastAPI's own description of it is not what is sent
                    operation["responses"]["422"] = answer
    _drop_unused(document)


def _drop_unused(document: dict[str, Any]) -> None:
    """FastAPI's own error types, which nothing refers to any more."""
    schemas: dict[str, Any] = document["components"]["schemas"]
    for name in ("HTTPValidationError", "ValidationError"):
        if f'"#/components/schemas/{name}"' not in str({**document, "components": {}}).replace("'", '"'):
            schemas.pop(name, None)
