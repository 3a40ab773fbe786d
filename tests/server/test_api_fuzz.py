"""Every route of the OpenAPI document against made-up requests: never a 5xx, always what the document says."""

from __future__ import annotations

from pathlib import Path

import schemathesis
from hypothesis import HealthCheck, given, settings
from live_server import TOKEN, running
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import response_schema_conformance, status_code_conformance

from server.access.policy import need
from server.access.roles import Role

CHECKS = [not_a_server_error, status_code_conformance, response_schema_conformance]
CALLERS = {
    "operator of this machine": (8, {}),
    "viewer": (2, {"Authorization": f"Bearer {TOKEN[Role.VIEWER]}"}),
    "wrong token": (1, {"Authorization": "Bearer wrong"}),
}
"""How many requests each makes of an operation, and its headers."""


def test_no_made_up_request_breaks_the_api(tmp_path: Path) -> None:
    with running(tmp_path) as (url, engine):
        document = schemathesis.openapi.from_url(f"{url}/openapi.json")
        operations = [found.ok() for found in document.get_all_operations()]
        for operation in operations:
            for who in CALLERS:
                attack(operation, who)
        assert len(operations) >= 40
        assert engine.is_alive()


def attack(operation: schemathesis.schemas.APIOperation, who: str) -> None:
    """Made-up requests of one operation by one caller; each is answered as documented, and as the role may."""
    count, headers = CALLERS[who]
    role = need(operation.method.upper(), operation.path).role

    # 503 is how a load balancer learns that the server is not ready
    checks = [check for check in CHECKS if check is not not_a_server_error or not operation.path.endswith("/ready")]

    @settings(max_examples=count, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(case=operation.as_strategy())
    def check(case: schemathesis.Case) -> None:
        answer = case.call_and_validate(checks=checks, headers=headers)
        if role is not None and who == "wrong token":
            assert answer.status_code in (401, 413, 429), operation.label
        if role is not None and who == "viewer" and role > Role.VIEWER:
            assert answer.status_code in (403, 413), operation.label

    check()
