"""An MCAP file by topic and by time, read chunk by chunk; opens files that were cut off in the middle."""

from __future__ import annotations

import logging
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import zstandard
from google.protobuf.message import DecodeError
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, Schema
from mcap.stream_reader import CRCValidationError, get_chunk_data_stream
from mcap_protobuf.decoder import DecoderFactory

from teleop.errors import RecordingError
from teleop.recording.mcap_scan import (
    MAGIC,
    MESSAGE_OVERHEAD,
    ChunkRef,
    Scan,
    index_content,
    message_at,
    scan,
)

_log = logging.getLogger(__name__)
_MAX_CHUNK_BYTES = 256 << 20
_LOOSE = -1
_DAMAGE = (McapError, zstandard.ZstdError, RuntimeError, ValueError, MemoryError, OverflowError, struct.error)
"""What mcap, zstandard and lz4 raise on damaged bytes."""


@dataclass(frozen=True, slots=True, eq=False)
class TopicIndex:
    """All messages of one topic in order of time; arrays (N,): log time, chunk number (-1: outside), offset."""

    channel: Channel
    t_ns: npt.NDArray[np.int64]
    chunk: npt.NDArray[np.int32]
    offset: npt.NDArray[np.int64]


class McapFile:
    """Random access to the messages of one file; holds one uncompressed chunk in memory. Not thread-safe."""

    def __init__(self, path: Path) -> None:
        """Open and index. Raises RecordingError when it is missing, not an MCAP, or holds nothing."""
        self.path = path
        try:
            self._file = path.open("rb")
            self.size_bytes = path.stat().st_size
        except FileNotFoundError:
            raise RecordingError(f"no recording at {path}") from None
        except OSError as error:
            raise RecordingError(f"cannot open {path}: {error.strerror or error}") from None
        self._cached: tuple[int, bytes] = (-2, b"")
        try:
            self._open()
        except BaseException:
            self._file.close()
            raise

    def _open(self) -> None:
        if self.size_bytes == 0:
            raise RecordingError(f"{self.path} is empty")
        if self._file.read(len(MAGIC)) != MAGIC:
            raise RecordingError(f"{self.path} is not an MCAP file; teleop reads .mcap recordings and RGB-D folders")
        self._scan = scan(self._file, self.size_bytes)
        self.truncated = self._scan.truncated
        self._complete_index()
        if self.truncated:
            _log.warning("%s: %s; reading up to its last complete chunk", self.path, self.truncated)
        self._topics = self._topic_indexes()
        self._decoders: dict[int, Callable[[bytes], Any]] = {}
        self._factory = DecoderFactory()

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self._file.close()

    @property
    def topics(self) -> dict[str, TopicIndex]:
        """Topics that hold at least one message."""
        return self._topics

    def metadata(self, name: str) -> dict[str, str]:
        """The metadata record of that name, or nothing."""
        return next((dict(m.metadata) for m in self._scan.metadata if m.name == name), {})

    def schema_name(self, topic: str) -> str:
        """Name of the topic's schema, empty when it has none."""
        schema = self.schema(topic)
        return schema.name if schema else ""

    def payload(self, topic: str, number: int) -> bytes:
        """Raw bytes of one message. Raises RecordingError when its chunk is damaged."""
        index = self._topics[topic]
        chunk, offset = int(index.chunk[number]), int(index.offset[number])
        if chunk == _LOOSE:
            entry = next(e for e in self._scan.loose[index.channel.id] if e[1] == offset)
            self._file.seek(offset + MESSAGE_OVERHEAD)
            return self._file.read(entry[2] - MESSAGE_OVERHEAD)
        found = message_at(self._chunk_data(chunk), offset)
        if found is None or found[0] != index.channel.id:
            raise RecordingError(f"{self.path}: the index points to no message at chunk {chunk}; the file is damaged")
        return bytes(found[1])

    def in_file_order(self) -> Iterator[tuple[str, int, bytes]]:
        """Topic, log time and raw bytes of every message, chunk after chunk."""
        every = [
            (int(chunk), int(offset), topic, number)
            for topic, index in self._topics.items()
            for number, (chunk, offset) in enumerate(zip(index.chunk, index.offset, strict=True))
        ]
        for _, _, topic, number in sorted(every):
            yield topic, int(self._topics[topic].t_ns[number]), self.payload(topic, number)

    @property
    def scan(self) -> Scan:
        """The records of the file, for who makes it whole again."""
        return self._scan

    def all_metadata(self) -> list[tuple[str, dict[str, str]]]:
        """Every metadata record."""
        return [(m.name, dict(m.metadata)) for m in self._scan.metadata]

    def schema(self, topic: str) -> Schema | None:
        """The topic's schema as it stands in the file."""
        return self._scan.schemas.get(self._topics[topic].channel.schema_id)

    def message(self, topic: str, number: int) -> Any:
        """One protobuf message, decoded with the schema in the file. Raises RecordingError."""
        channel = self._topics[topic].channel
        decoder = self._decoders.get(channel.id)
        if decoder is None:
            decoder = self._decoders[channel.id] = self._decoder(channel)
        try:
            return decoder(self.payload(topic, number))
        except DecodeError as error:
            raise RecordingError(f"{self.path}: message {number} of {topic} is damaged: {error}") from None

    def _decoder(self, channel: Channel) -> Callable[[bytes], Any]:
        schema = self._scan.schemas.get(channel.schema_id)
        try:
            decoder = self._factory.decoder_for(channel.message_encoding, schema)
        except (McapError, DecodeError, TypeError, KeyError, ValueError) as error:
            raise RecordingError(f"{self.path}: schema of {channel.topic} cannot be used: {error}") from None
        if decoder is None:
            raise RecordingError(
                f"{self.path}: {channel.topic} is encoded as '{channel.message_encoding}'; "
                "teleop reads Foxglove protobuf messages"
            )
        return decoder

    def _chunk_data(self, number: int) -> bytes:
        if self._cached[0] != number:
            self._cached = (number, self._read_chunk(self._scan.chunks[number]))
        return self._cached[1]

    def _read_chunk(self, ref: ChunkRef) -> bytes:
        if ref.uncompressed_bytes > _MAX_CHUNK_BYTES:
            raise RecordingError(f"{self.path}: a chunk claims {ref.uncompressed_bytes} bytes; the file is damaged")
        self._file.seek(ref.offset)
        try:
            chunk = Chunk.read(ReadDataStream(BytesIO(self._file.read(ref.length))))
            stream, length = get_chunk_data_stream(chunk, validate_crc=True)
            return stream.read(length)
        except CRCValidationError:
            raise RecordingError(f"{self.path}: the chunk at byte {ref.offset} fails its check sum") from None
        except _DAMAGE as error:
            raise RecordingError(f"{self.path}: the chunk at byte {ref.offset} is damaged: {error}") from error

    def _complete_index(self) -> None:
        """Index from their content the chunks whose message indexes are missing or may be cut off."""
        chunks = self._scan.chunks
        for number, ref in enumerate(chunks):
            unknown = set(ref.entries) - set(self._scan.channels)
            cut_off = self._scan.truncated is not None and number == len(chunks) - 1
            if ref.entries and not unknown and not cut_off:
                continue
            try:
                ref.entries, problem = index_content(self._scan, self._read_chunk(ref))
            except RecordingError as error:
                problem = str(error)
            if problem:
                self.truncated = self.truncated or problem
                self._scan.torn = self._scan.torn and number == len(chunks) - 1
                self._scan.data_end = min(self._scan.data_end, ref.start)
                del chunks[number:]
                return

    def _topic_indexes(self) -> dict[str, TopicIndex]:
        parts: dict[int, list[tuple[npt.NDArray[np.int64], int, npt.NDArray[np.int64]]]] = {}
        for number, ref in enumerate(self._scan.chunks):
            for channel_id, entries in ref.entries.items():
                part = (entries["t_ns"].astype(np.int64), number, entries["offset"].astype(np.int64))
                parts.setdefault(channel_id, []).append(part)
        for channel_id, loose in self._scan.loose.items():
            times, offsets, _ = (np.array(column, dtype=np.int64) for column in zip(*loose, strict=True))
            parts.setdefault(channel_id, []).append((times, _LOOSE, offsets))
        found: dict[str, TopicIndex] = {}
        for channel_id, pieces in parts.items():
            channel = self._scan.channels.get(channel_id)
            if channel is None:
                continue
            t_ns = np.concatenate([p[0] for p in pieces])
            chunk = np.concatenate([np.full(len(p[0]), p[1], dtype=np.int32) for p in pieces])
            offset = np.concatenate([p[2] for p in pieces])
            order = np.argsort(t_ns, kind="stable")
            index = TopicIndex(channel, t_ns[order], chunk[order], offset[order])
            known = found.get(channel.topic)
            if known is None or len(index.t_ns) > len(known.t_ns):
                found[channel.topic] = index
        return found
