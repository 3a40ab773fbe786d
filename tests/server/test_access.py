"""Every kind of request that must be refused is, with its status, over the real application."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from live_server import TOKEN, prepared
from starlette.testclient import TestClient, WebSocketTestSession
from starlette.websockets import WebSocketDisconnect

from server import wire
from server.access.policy import need
from server.access.roles import Role
from server.engine.engine import Engine
from teleop.recording import McapSource

ROBOT = "http://robot.example:8000"
FAR = ("192.0.2.7", 50000)
LIMITS = {"commands_per_s": 1, "command_burst": 60, "failed_logins_per_min": 4, "lease_idle_s": 1.0}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[FastAPI, Engine]]:
    folder = tmp_path_factory.mktemp("access")
    with (
        prepared(folder, host="0.0.0.0", access=LIMITS, upload={"json_kb": 4}) as (app, engine),
        TestClient(app) as first,
    ):
        app.state.portal = first.portal
        yield app, engine


@pytest.fixture
def app(made: tuple[FastAPI, Engine]) -> Iterator[FastAPI]:
    """Nobody holds the lease, before and after."""
    desk = made[0].state.desk
    yield made[0]
    while desk.lease.holder is not None:
        desk.release(desk.lease.holder)


def far(app: FastAPI, role: Role | None = None, key: str = "", address: str = FAR[0], **headers: str) -> TestClient:
    """A client on another machine."""
    given = {"Authorization": f"Bearer {TOKEN[role]}"} if role else {}
    given |= {"X-Teleop-Client": key} if key else {}
    return on_one_loop(TestClient(app, base_url=ROBOT, headers={**given, **headers}, client=(address, 50000)), app)


def near(app: FastAPI, key: str = "", **headers: str) -> TestClient:
    """A client on the server's own machine."""
    given = {"X-Teleop-Client": key} if key else {}
    client = TestClient(
        app, base_url="http://127.0.0.1:8000", headers={**given, **headers}, client=("127.0.0.1", 50000)
    )
    return on_one_loop(client, app)


def on_one_loop(client: TestClient, app: FastAPI) -> TestClient:
    """All clients meet on the loop that the application started on, as they do in a server."""
    client.portal = app.state.portal
    return client


@contextmanager
def socket_of(client: TestClient, path: str) -> Iterator[WebSocketTestSession]:
    """A websocket to the client's own host. The test client cancels a handler that has not ended when it leaves."""
    with (
        suppress(CancelledError),
        client.websocket_connect(str(client.base_url.copy_with(scheme="ws", path="/")).rstrip("/") + path) as session,
    ):
        yield session


def refused(response: httpx.Response, status: int, code: str | None, *words: str) -> None:
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    body = response.json()
    assert body["status"] == status and body.get("code") == code, body
    for word in words:
        assert word in body["detail"], body["detail"]


def api_routes(app: FastAPI) -> list[tuple[str, str]]:
    found = [
        (method.upper(), path)
        for path, methods in app.openapi()["paths"].items()
        for method in methods
        if path.startswith("/api/v1")
    ]
    assert len(found) > 35
    return found


def filled(path: str) -> str:
    return path.replace("{", "").replace("}", "")


def test_without_a_token_only_health_readiness_and_login_answer(app: FastAPI) -> None:
    client = far(app)
    for method, path in api_routes(app):
        response = client.request(method, filled(path))
        if need(method, path).role is None:
            assert response.status_code != 401, path
        else:
            refused(response, 401, "token", "Authorization: Bearer")
            assert response.headers["WWW-Authenticate"] == "Bearer"
    assert client.get("/metrics").status_code == 401


def test_a_viewer_sees_everything_changes_nothing_and_stops_the_robot(app: FastAPI) -> None:
    client = far(app, Role.VIEWER, "v" * 16)
    for method, path in api_routes(app):
        if method == "GET" and "{" not in path and "ready" not in path:
            assert client.get(path).status_code in (200, 404, 409, 503), path
        elif need(method, path).role not in (None, Role.VIEWER):
            refused(client.request(method, filled(path), json={}), 403, "role", "yours is viewer")
    assert client.get("/api/v1/state").status_code == 200
    assert client.post("/api/v1/estop").json() == {"accepted": True}
    refused(client.post("/api/v1/estop/reset"), 403, "role", "needs the role operator")
    assert near(app).post("/api/v1/estop/reset").status_code == 200


def test_this_machine_operates_without_a_token_unless_something_stands_between(app: FastAPI) -> None:
    assert near(app).get("/api/v1/access").json()["you"]["role"] == "operator"
    assert far(app).get("/api/v1/access").json() == {
        "type": "access",
        "you": None,
        "holds_lease": False,
        "lease": {"holder": None, "requests": [], "since": None},
        "by_token": False,
    }
    # a proxy on this machine, and a page whose name resolves to it
    refused(near(app, **{"X-Forwarded-For": "198.51.100.1"}).get("/api/v1/state"), 401, "token")
    refused(near(app, Host="evil.example:8000").get("/api/v1/state"), 401, "token")
    # what is given counts before the place it comes from
    refused(near(app, Authorization=f"Bearer {TOKEN[Role.VIEWER]}").post("/api/v1/engage"), 403, "role")
    refused(near(app, Authorization="Bearer rubbish", Host="127.0.0.1:8000").get("/api/v1/state"), 401, "token")


def test_a_browser_logs_in_and_out(app: FastAPI) -> None:
    client = far(app)
    answer = client.post("/api/v1/login", json={"token": TOKEN[Role.SUPERVISOR]})
    assert answer.json()["you"]["role"] == "supervisor"
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie and "samesite=strict" in cookie and TOKEN[Role.SUPERVISOR].lower() not in cookie
    assert client.get("/api/v1/state").status_code == 200
    with socket_of(client, "/api/v1/stream") as stream:
        assert stream.receive_json()["type"] == "hello"
    assert client.post("/api/v1/logout").status_code == 204
    refused(client.get("/api/v1/state"), 401, "token")


def test_tokens_cannot_be_tried_out(app: FastAPI) -> None:
    client = far(app, address="198.51.100.9")
    for _ in range(4):
        refused(client.post("/api/v1/login", json={"token": "guess"}), 401, "token", "not known here")
    answer = client.post("/api/v1/login", json={"token": "guess"})
    refused(answer, 429, "rate", "too many wrong tokens")
    assert int(answer.headers["Retry-After"]) >= 1
    refused(far(app, address="198.51.100.9", Authorization="Bearer guess").get("/api/v1/state"), 429, "rate")
    assert client.post("/api/v1/login", json={"token": TOKEN[Role.OPERATOR]}).status_code == 200, "nobody is locked out"


def test_a_flood_of_commands_is_refused_but_never_the_emergency_stop(app: FastAPI) -> None:
    client = far(app, Role.OPERATOR, "f" * 16, address="198.51.100.10")
    answers = [client.post("/api/v1/disengage") for _ in range(90)]
    assert answers[0].status_code == 200
    refused(answers[-1], 429, "rate", "commands a second")
    assert int(answers[-1].headers["Retry-After"]) >= 1
    assert all(client.post("/api/v1/estop").status_code == 200 for _ in range(90))
    assert near(app, "f" * 16).post("/api/v1/estop/reset").status_code == 200, "another address has its own rate"


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://robot.example:8001", "https://evil.example"])
def test_foreign_pages_may_not_command(app: FastAPI, origin: str) -> None:
    client = far(app, Role.SUPERVISOR, Origin=origin)
    refused(client.post("/api/v1/estop"), 403, "origin")
    with pytest.raises(WebSocketDisconnect) as closed, socket_of(client, "/api/v1/stream"):
        pass
    assert closed.value.code == 1008
    assert far(app, Role.SUPERVISOR, Origin=ROBOT).post("/api/v1/lease/release").status_code == 200


def test_what_is_no_json_names_no_client_or_is_too_large_is_refused(app: FastAPI) -> None:
    client = far(app, Role.OPERATOR)
    form = client.post("/api/v1/robot/command", data={"lift_m": "0.1"})
    refused(form, 422, None)
    plain = client.post("/api/v1/robot/command", content='{"lift_m":0.1}', headers={"Content-Type": "text/plain"})
    refused(plain, 422, None)
    refused(far(app, Role.OPERATOR, "../../etc/passwd").get("/api/v1/state"), 422, None, "client key")
    refused(client.post("/api/v1/robot/command", json={"lift_m": "x" * 5000}), 413, "size", "4000 bytes")
    refused(client.post("/api/v1/lease/grant", json={"to": 3}), 422, None, "to")
    for name in ("..%2f..%2fetc%2fpasswd", "%2e%2e%2faccess", "..\\access.json"):
        assert client.get(f"/api/v1/recordings/{name}").status_code in (404, 405)
        assert client.delete(f"/api/v1/recordings/{name}").status_code in (403, 404, 405)


def test_websockets_say_by_their_code_why_they_close(app: FastAPI) -> None:
    def code(client: TestClient, path: str) -> int:
        with socket_of(client, path) as socket, pytest.raises(WebSocketDisconnect) as closed:
            socket.receive_json()
        return closed.value.code

    assert code(far(app), "/api/v1/stream") == 4401
    assert code(far(app), "/api/v1/push") == 4401
    assert code(far(app, Role.VIEWER), "/api/v1/push") == 4403
    with socket_of(far(app, Role.VIEWER), "/api/v1/stream") as stream:
        assert stream.receive_json()["type"] == "hello"
        stream.send_text("x" * 2000)
        closed = next(m for _ in range(400) if (m := stream.receive())["type"] == "websocket.close")
        assert closed["code"] == 1008 and "1000 characters" in closed["reason"]


def next_access(stream: WebSocketTestSession, wanted: Callable[[wire.Access], bool]) -> wire.Access:
    for _ in range(400):
        message = stream.receive()
        if "text" in message and '"type":"access"' in message["text"]:
            found = wire.Access.model_validate_json(message["text"])
            if wanted(found):
                return found
    raise AssertionError("no such access message")


def test_two_consoles_hand_the_lease_over(app: FastAPI) -> None:
    anna, ben = far(app, Role.OPERATOR, "a" * 16, **{"X-Teleop-Name": "Anna"}), near(app, "b" * 16)
    with socket_of(anna, "/api/v1/stream") as a, socket_of(ben, "/api/v1/stream") as b:
        assert anna.post("/api/v1/disengage").status_code == 200
        assert next_access(a, lambda m: m.holds_lease).you is not None
        seen = next_access(b, lambda m: m.lease.holder is not None)
        assert seen.lease.holder is not None and seen.lease.holder.name == "Anna" and not seen.holds_lease
        refused(ben.post("/api/v1/robot/command", json={"lift_m": 0.1}), 423, "lease", "Anna is in control")
        refused(near(app).post("/api/v1/disengage"), 423, "lease")
        asked = ben.post("/api/v1/lease/request").json()
        assert not asked["holds_lease"] and len(asked["lease"]["requests"]) == 1
        wish = next_access(a, lambda m: bool(m.lease.requests)).lease.requests[0]
        refused(ben.post("/api/v1/lease/grant", json={"to": wish.id}), 423, "lease")
        assert anna.post("/api/v1/lease/grant", json={"to": wish.id}).json()["lease"]["holder"]["id"] == wish.id
        assert next_access(b, lambda m: m.holds_lease)
        assert ben.post("/api/v1/robot/command", json={"lift_m": 0.1}).status_code == 200
        assert near(app).post("/api/v1/disengage").status_code == 200, "a script beside the holder acts for it"
        refused(anna.post("/api/v1/engage"), 423, "lease")


def test_a_supervisor_takes_over_and_the_operator_is_disengaged(app: FastAPI, made: tuple[FastAPI, Engine]) -> None:
    anna, eve = far(app, Role.OPERATOR, "a" * 16), far(app, Role.SUPERVISOR, "e" * 16)
    assert anna.post("/api/v1/lease/request").json()["holds_lease"]
    refused(anna.post("/api/v1/lease/take"), 403, "role", "needs the role supervisor")
    assert anna.post("/api/v1/sessions", json={"source": "walk", "loop": True}).status_code == 201
    until(lambda: eve.get("/api/v1/state").json()["mode"] == "seen")
    anna.post("/api/v1/engage")
    until(lambda: eve.get("/api/v1/state").json()["engaged"])
    assert eve.post("/api/v1/lease/take").json()["holds_lease"]
    until(lambda: not eve.get("/api/v1/state").json()["engaged"])
    refused(anna.post("/api/v1/engage"), 423, "lease")


def test_the_lease_of_a_client_that_is_gone_lapses(app: FastAPI) -> None:
    gone, waiting = far(app, Role.OPERATOR, "g" * 16), far(app, Role.OPERATOR, "w" * 16)
    with socket_of(waiting, "/api/v1/stream") as stream:
        with socket_of(gone, "/api/v1/stream"):
            gone.post("/api/v1/lease/request")
            waiting.post("/api/v1/lease/request")
        assert next_access(stream, lambda m: m.holds_lease)


def test_who_did_what_is_in_the_recording(app: FastAPI, tmp_path: Path) -> None:
    client = far(app, Role.OPERATOR, "r" * 16, **{"X-Teleop-Name": "R%C3%B3sa"})
    name = client.post("/api/v1/sessions", json={"source": "walk", "record": True}).json()["recording"]
    until(lambda: client.get("/api/v1/state").json()["skeleton"])
    client.post("/api/v1/estop")
    client.post("/api/v1/estop/reset")
    running = next(s for s in client.get("/api/v1/sessions").json() if s["running"])
    client.delete(f"/api/v1/sessions/{running['id']}")
    path = tmp_path / "mine.mcap"
    path.write_bytes(client.get(f"/api/v1/recordings/{name}").content)
    source = McapSource(path)
    told = [row for _, row in source.rows("/teleop/events") if row["kind"] == "audit"]
    source.close()
    assert {"audit.sessions", "audit.estop", "audit.estop.reset"} <= {row["reason"] for row in told}
    assert all("Rósa" in row["detail"] for row in told)
    told = [row for row in told if "lease" not in row["reason"]]
    assert all("192.0.2.7" in row["detail"] for row in told)


def test_what_was_missed_while_cut_off_is_told(app: FastAPI, made: tuple[FastAPI, Engine]) -> None:
    client, announce = far(app, Role.VIEWER), made[1].publisher.announce

    def greeting(query: str = "") -> tuple[dict[str, Any], list[dict[str, Any]]]:
        announce("test", "test.marker")
        with socket_of(client, f"/api/v1/stream{query}") as stream:
            hello, events = stream.receive_json(), []
            for _ in range(2000):
                message = stream.receive()
                if "text" in message and '"type":"event"' in message["text"]:
                    events.append(wire.EventMessage.model_validate_json(message["text"]).model_dump())
                if events and events[-1]["reason"] == "test.marker":
                    return hello, events
        raise AssertionError("no marker came")

    hello, events = greeting()
    last = events[-1]["id"]
    assert hello["boot"] and hello["missed_events"] == 0 and last > 0
    for i in range(3):
        announce("test", "test.missed", str(i))
    _, missed = greeting(f"?boot={hello['boot']}&after={last}")
    assert [e["detail"] for e in missed if e["kind"] == "test"] == ["0", "1", "2", ""]
    for i in range(400):
        announce("test", "test.many", str(i))
    late, held = greeting(f"?boot={hello['boot']}&after={last}")
    assert late["missed_events"] == held[0]["id"] - last - 1 > 0
    _, other = greeting(f"?boot=anotherstart&after={last + 10**6}")
    assert 45 <= len(other) <= 55, "of another start of the server: as a new client"


def until(ask: Callable[[], Any], timeout_s: float = 20.0) -> Any:
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        if answer := ask():
            return answer
        time.sleep(0.02)
    raise AssertionError("it never came true")
