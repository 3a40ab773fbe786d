"""Every route of the OpenAPI document against made-up requests: never a 5xx, always what the document says."""

from __future__ import annotations

from pathlib import Path

import schemathesis
from hypothesis import HealthCheck, given, settings
from live_server import running
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import response_schema_conformance, status_code_conformance

CHECKS = [not_a_server_error, status_code_conformance, response_schema_conformance]


def test_no_made_up_request_breaks_the_api(tmp_path: Path) -> None:
    with running(tmp_path) as (url, engine):
        document = schemathesis.openapi.from_url(f"{url}/openapi.json")
        tried = 0
        for found in document.get_all_operations():
            operation = found.ok()

            @settings(max_examples=8, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
            @given(case=operation.as_strategy())
            def check(case: schemathesis.Case) -> None:
                case.call_and_validate(checks=CHECKS)

            check()
            tried += 1
        assert tried >= 20
        assert engine.is_alive()
