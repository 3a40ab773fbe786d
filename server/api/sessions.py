"""Sessions: which source is read, and whether it is recorded."""

from __future__ import annotations

from fastapi import APIRouter, Response

from server.api.deps import EngineDep, LibraryDep
from server.api.models import SessionAsk, SessionState
from server.api.problems import documented
from server.engine.session import Session
from server.errors import Refused
from server.opening import open_named
from teleop.errors import TeleopError

router = APIRouter(prefix="/sessions", tags=["sessions"])


@router.get("")
def list_sessions(engine: EngineDep) -> list[SessionState]:
    """Oldest first."""
    return [_described(session) for session in engine.sessions]


@router.post("", status_code=201, responses=documented(403, 404, 422, 503))
def open_session(engine: EngineDep, library: LibraryDep, ask: SessionAsk, response: Response) -> SessionState:
    """Open a source; the session before it ends. The robot holds until somebody engages."""
    try:
        session = open_named(engine, library, ask.source, loop=ask.loop, record=ask.record)
    except Refused:
        raise
    except TeleopError as error:
        raise Refused(422, str(error)) from error
    response.headers["Location"] = f"/api/v1/sessions/{session.id}"
    return _described(session)


@router.get("/{session_id}", responses=documented(404))
def read_session(engine: EngineDep, session_id: str) -> SessionState:
    """One session."""
    return _described(_find(engine.sessions, session_id))


@router.delete("/{session_id}", status_code=204, responses=documented(404, 503))
def close_session(engine: EngineDep, session_id: str) -> None:
    """End a session; closing a finished one does no harm."""
    engine.close_session(_find(engine.sessions, session_id).id)


def _find(sessions: tuple[Session, ...], session_id: str) -> Session:
    for session in sessions:
        if session.id == session_id:
            return session
    raise Refused(404, f"no session '{session_id[:40]}'; list them with GET /api/v1/sessions")


def _described(session: Session) -> SessionState:
    return SessionState(
        id=session.id,
        source=session.name,
        kind=session.info.kind,
        live=session.info.live,
        running=session.ended is None,
        started=session.started,
        ended=session.ended,
        duration_s=session.info.duration_s,
        recording=session.recording,
        fault=session.fault,
    )
