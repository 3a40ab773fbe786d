"""The recordings library: list, upload, download, delete."""

from __future__ import annotations

from fastapi import APIRouter, Response, UploadFile
from fastapi.responses import FileResponse

from server.api.deps import EngineDep, LibraryDep
from server.api.models import Recording, Story
from server.api.problems import documented
from server.errors import Refused
from server.library import Entry
from server.story import read_picture, read_story
from teleop.errors import RecordingError

router = APIRouter(prefix="/recordings", tags=["recordings"])


@router.get("")
def list_recordings(library: LibraryDep) -> list[Recording]:
    """Bundled ones first, then the newest."""
    return [_described(library.duration_s(entry), entry) for entry in library.entries()]


@router.post("", status_code=201, responses=documented(409, 413, 422))
def upload_recording(library: LibraryDep, file: UploadFile) -> Recording:
    """Take an MCAP recording in under its own file name."""
    try:
        entry = library.store(file.filename or "", file.file)
    except RecordingError as error:
        raise Refused(422, str(error)) from error
    return _described(library.duration_s(entry), entry)


@router.get("/{recording_id}", response_class=FileResponse, responses=documented(404))
def download_recording(library: LibraryDep, recording_id: str) -> FileResponse:
    """The file itself."""
    entry = library.find(recording_id)
    return FileResponse(entry.path, media_type="application/octet-stream", filename=entry.path.name)


@router.get("/{recording_id}/story", responses=documented(404, 422))
def read_recording_story(library: LibraryDep, recording_id: str) -> Story:
    """What happened in it: events and modes by position, for a timeline."""
    try:
        return read_story(library.find(recording_id).path)
    except RecordingError as error:
        raise Refused(422, str(error)) from error


@router.get(
    "/{recording_id}/preview.jpg",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}}, **documented(404, 422)},
)
def recording_preview(engine: EngineDep, library: LibraryDep, recording_id: str) -> Response:
    """A picture from its middle."""
    try:
        picture = read_picture(library.find(recording_id).path, engine.settings.stream)
    except RecordingError as error:
        raise Refused(422, str(error)) from error
    return Response(picture, media_type="image/jpeg", headers={"Cache-Control": "private, max-age=3600"})


@router.delete("/{recording_id}", status_code=204, responses=documented(403, 404, 409))
def delete_recording(library: LibraryDep, engine: EngineDep, recording_id: str) -> None:
    """Remove an own recording; one that is playing or being written is not removed."""
    session = engine.session
    if session is not None and recording_id in (session.name, session.recording):
        raise Refused(409, f"'{recording_id}' is in use; close its session first")
    library.delete(recording_id)


def _described(duration_s: float | None, entry: Entry) -> Recording:
    return Recording(
        id=entry.id,
        name=entry.id.replace("_", " "),
        uri=entry.id,
        bundled=entry.bundled,
        size_bytes=entry.size_bytes,
        modified=entry.modified_s,
        duration_s=duration_s,
    )
