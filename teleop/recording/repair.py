"""A recording that was cut off, made whole again: every readable message, and the index that other readers need.

A file whose tail is missing gets its closing records in place; one damaged in its middle is copied up to there, and
what it was is kept beside it.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from mcap.writer import CompressionType, Writer

from teleop.config.recording import RecordingConfig
from teleop.errors import RecordingError
from teleop.recording.mcap_file import McapFile
from teleop.recording.mcap_scan import MAGIC
from teleop.recording.output import is_being_written
from teleop.recording.seal import seal


def repair(path: Path) -> int:
    """Make a recording that was cut off whole; a whole one is left alone, a damaged one is kept as NAME.damaged.

    Returns the number of messages saved, 0 when there was nothing to do. Raises RecordingError; then the file can be
    read as before.
    """
    if path.is_file() and is_being_written(path):
        raise RecordingError(f"{path} is being written now; repair it when that has ended")
    file = McapFile(path)
    partial = path.with_name(path.name + ".partial")
    try:
        if file.truncated is None:
            return 0
        if not file.topics:
            raise RecordingError(f"{path} holds no complete chunk of messages; nothing can be saved")
        if file.scan.torn:
            return seal(path, file.scan)
        count = _copy(file, partial)
        path.rename(_free_name(path))
        partial.rename(path)
    except OSError as error:
        raise RecordingError(f"cannot repair {path}: {error.strerror or error}; free some space") from None
    finally:
        file.close()
        partial.unlink(missing_ok=True)
    return count


def repair_folder(folder: Path) -> Iterator[str]:
    """Make every recording of a folder that a crash cut off whole again; one line of report for each.

    Whole recordings are only looked at their ends, those being written are left alone.
    """
    for path in sorted(folder.glob("*.mcap")):
        try:
            if not path.is_file() or _has_its_end(path) or is_being_written(path):
                continue
            yield f"{path.name} was cut off: {repair(path)} messages saved"
        except (RecordingError, OSError) as error:
            yield f"{path.name} was cut off and cannot be repaired: {error}"


def _free_name(path: Path) -> Path:
    names = (path.with_name(f"{path.name}.damaged{number or ''}") for number in range(1000))
    return next(name for name in names if not name.exists())


def _has_its_end(path: Path) -> bool:
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - len(MAGIC)))
        return file.read() == MAGIC


def _copy(file: McapFile, output: Path) -> int:
    count = 0
    with output.open("wb") as stream:
        writer = Writer(stream, chunk_size=RecordingConfig().chunk_mb << 20, compression=CompressionType.ZSTD)
        writer.start()
        for name, content in file.all_metadata():
            writer.add_metadata(name, content)
        channels: dict[str, int] = {}
        schemas: dict[int, int] = {0: 0}
        for topic, t_ns, data in file.in_file_order():
            if topic not in channels:
                channel, schema = file.topics[topic].channel, file.schema(topic)
                if schema is not None and schema.id not in schemas:
                    schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
                schema_id = schemas[schema.id] if schema is not None else 0
                channels[topic] = writer.register_channel(
                    topic, channel.message_encoding, schema_id, dict(channel.metadata)
                )
            writer.add_message(channels[topic], t_ns, data, publish_time=t_ns, sequence=count)
            count += 1
        writer.finish()
    return count
