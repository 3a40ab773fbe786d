"""Index of an MCAP file, built by walking its records without reading the images in them.

One way for whole files and for files cut off by a crash: the summary at the end is never needed. Layout after
the MCAP specification (https://mcap.dev/spec): every record is an opcode, a length, and that many bytes; a chunk
is followed by one message index per channel.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from io import BytesIO
from typing import BinaryIO

import numpy as np
import numpy.typing as npt
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema

MAGIC = b"\x89MCAP0\r\n"
_HEADER = struct.Struct("<BQ")
HEADER_BYTES = _HEADER.size
_CHUNK = struct.Struct("<QQQI")
_MESSAGE = struct.Struct("<HIQQ")
_INDEX = struct.Struct("<HI")
MESSAGE_OVERHEAD = _MESSAGE.size
_SMALL_RECORD_BYTES = 64 << 20
"""No schema, channel, metadata or index is larger in an honest file."""
_ENTRY = np.dtype([("t_ns", "<u8"), ("offset", "<u8")])

EntryArray = npt.NDArray[np.void]


@dataclass(slots=True)
class ChunkRef:
    """Where a chunk lies: offset and length of its record's content. entries: channel id -> message index.

    index_at: channel id -> where its message index record begins. index_end: where the last of them ends.
    """

    offset: int
    length: int
    uncompressed_bytes: int
    entries: dict[int, EntryArray] = field(default_factory=dict)
    index_at: dict[int, int] = field(default_factory=dict)
    index_end: int = 0

    @property
    def start(self) -> int:
        """Where its record begins."""
        return self.offset - HEADER_BYTES

    @property
    def end(self) -> int:
        """Where its record ends."""
        return self.offset + self.length


@dataclass(slots=True)
class Scan:
    """What the walk found. loose: messages outside chunks, as channel id -> [(t_ns, file offset, bytes)].

    metadata_at: offset and length of each metadata record. data_end: end of the last whole record before the
    closing ones. truncated: why the walk ended before the file's proper end, or None. torn: only its tail is
    missing, all that stands before it is whole.
    """

    chunks: list[ChunkRef] = field(default_factory=list)
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: list[Metadata] = field(default_factory=list)
    metadata_at: list[tuple[int, int]] = field(default_factory=list)
    loose: dict[int, list[tuple[int, int, int]]] = field(default_factory=dict)
    data_end: int = len(MAGIC)
    truncated: str | None = None
    torn: bool = False


def scan(file: BinaryIO, file_bytes: int) -> Scan:
    """Walk all records of an open file whose magic has been checked."""
    found = Scan()
    position = len(MAGIC)
    closing = False
    while True:
        file.seek(position)
        header = file.read(_HEADER.size)
        if len(header) < _HEADER.size:
            found.truncated, found.torn = "the file ends without its closing records", True
            return found
        opcode, length = _HEADER.unpack(header)
        position += _HEADER.size
        if opcode == 0 or position + length > file_bytes:
            found.truncated = f"the record at byte {position - _HEADER.size} is incomplete"
            found.torn = True
            return found
        if opcode == Opcode.FOOTER:
            file.seek(position + length)
            if file.read(len(MAGIC)) != MAGIC:
                found.truncated, found.torn = "the file ends inside its closing records", True
            return found
        problem = _record(file, found, opcode, position, length)
        if problem is not None:
            found.truncated = f"{problem} at byte {position - _HEADER.size}"
            return found
        position += length
        closing = closing or opcode == Opcode.DATA_END
        if not closing:
            found.data_end = position


def _record(file: BinaryIO, found: Scan, opcode: int, position: int, length: int) -> str | None:
    """Take in one record; a sentence about what is wrong with it, or None."""
    if opcode == Opcode.CHUNK:
        if length < _CHUNK.size + 12:
            return "an unfinished chunk"
        _start, _end, uncompressed, _crc = _CHUNK.unpack(file.read(_CHUNK.size))
        found.chunks.append(ChunkRef(position, length, uncompressed))
    elif opcode == Opcode.MESSAGE:
        if length < _MESSAGE.size:
            return "a damaged message"
        channel, _seq, t_ns, _publish = _MESSAGE.unpack(file.read(_MESSAGE.size))
        found.loose.setdefault(channel, []).append((t_ns, position, length))
    elif opcode in (Opcode.MESSAGE_INDEX, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA):
        if length > _SMALL_RECORD_BYTES:
            return "an oversized record"
        return _small(found, opcode, position, file.read(length))
    return None


def _small(found: Scan, opcode: int, position: int, content: bytes) -> str | None:
    if opcode == Opcode.MESSAGE_INDEX:
        if len(content) < _INDEX.size or not found.chunks:
            return "a damaged message index"
        channel_id, _ = _INDEX.unpack_from(content)
        body = content[_INDEX.size :]
        if len(body) % _ENTRY.itemsize:
            return "a damaged message index"
        chunk = found.chunks[-1]
        chunk.index_end = position + len(content)
        if body:
            chunk.entries[channel_id] = np.frombuffer(body, dtype=_ENTRY)
            chunk.index_at[channel_id] = position - HEADER_BYTES
        return None
    problem = definition(found, opcode, content)
    if problem is None and opcode == Opcode.METADATA:
        found.metadata_at.append((position - HEADER_BYTES, HEADER_BYTES + len(content)))
    return problem


def definition(found: Scan, opcode: int, content: bytes) -> str | None:
    """Take in a schema, channel or metadata record; a sentence about what is wrong with it, or None."""
    stream = ReadDataStream(BytesIO(content))
    try:
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            found.schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            found.channels[channel.id] = channel
        elif opcode == Opcode.METADATA:
            found.metadata.append(Metadata.read(stream))
    except (EndOfFile, struct.error, UnicodeDecodeError, MemoryError, OverflowError):
        return "a damaged definition"
    return None


def index_content(found: Scan, data: bytes) -> tuple[dict[int, EntryArray], str | None]:
    """Index a chunk from its uncompressed records; also takes in the schemas and channels defined there.

    Returns channel id -> message index, and what is wrong with the chunk, if anything.
    """
    lists: dict[int, list[tuple[int, int]]] = {}
    position, problem = 0, None
    while position < len(data):
        if position + _HEADER.size > len(data):
            problem = "a chunk ends inside a record"
            break
        opcode, length = _HEADER.unpack_from(data, position)
        body = position + _HEADER.size
        if body + length > len(data):
            problem = "a chunk ends inside a record"
            break
        if opcode == Opcode.MESSAGE and length >= _MESSAGE.size:
            channel, _seq, t_ns, _publish = _MESSAGE.unpack_from(data, body)
            lists.setdefault(channel, []).append((t_ns, position))
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            problem = definition(found, opcode, data[body : body + length]) or problem
        position = body + length
    return {channel: np.array(pairs, dtype=_ENTRY) for channel, pairs in lists.items()}, problem


def message_at(data: bytes, offset: int) -> tuple[int, memoryview] | None:
    """Channel id and payload of the message record at ``offset`` of a chunk, or None when none lies there."""
    if offset + _HEADER.size + _MESSAGE.size > len(data):
        return None
    opcode, length = _HEADER.unpack_from(data, offset)
    body = offset + _HEADER.size
    if opcode != Opcode.MESSAGE or length < _MESSAGE.size or body + length > len(data):
        return None
    channel = _MESSAGE.unpack_from(data, body)[0]
    return channel, memoryview(data)[body + _MESSAGE.size : body + length]
