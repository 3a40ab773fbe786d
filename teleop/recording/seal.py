"""Gives a recording that was cut off its closing records, in place: nothing is copied, whatever its size.

Cut behind the last whole chunk, then the records that every other reader starts from: message indexes of that chunk,
data end, schemas, channels, chunk indexes, statistics, metadata index, footer (https://mcap.dev/spec).
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO, Protocol

import numpy as np
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    ChunkIndex,
    DataEnd,
    Footer,
    MessageIndex,
    MetadataIndex,
    Statistics,
    SummaryOffset,
)

from teleop.recording.mcap_scan import HEADER_BYTES, MAGIC, ChunkRef, Scan

_CHUNK = struct.Struct("<QQQII")
"""Start and end time, uncompressed bytes, check sum, length of the compression's name."""


def seal(path: Path, found: Scan) -> int:
    """Close the file behind the last whole record of ``found``; its chunks must be indexed. Returns the messages.

    Raises OSError; the file can then be sealed again.
    """
    with path.open("r+b") as file:
        last = found.chunks[-1] if found.chunks else None
        rewrite = last is not None and last.end <= found.data_end and not _is_indexed(last)
        end = last.end if last is not None and rewrite else found.data_end
        tail = _Tail(file, found, end)
        if last is not None and rewrite:
            tail.index(last)
        data = tail.close()
        file.seek(end)
        file.truncate()
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    return tail.messages


def _is_indexed(chunk: ChunkRef) -> bool:
    return set(chunk.entries) == set(chunk.index_at)


class _Record(Protocol):
    def write(self, stream: RecordBuilder) -> None: ...


class _Tail:
    """The bytes that go behind ``end``."""

    def __init__(self, file: BinaryIO, found: Scan, end: int) -> None:
        self._file = file
        self._found = found
        self._end = end
        self._out = RecordBuilder()
        self._groups: list[SummaryOffset] = []
        self.messages = 0

    @property
    def _at(self) -> int:
        return self._end + self._out.count

    def index(self, chunk: ChunkRef) -> None:
        """Message indexes of a chunk that lacks some."""
        chunk.index_at.clear()
        for channel_id, entries in chunk.entries.items():
            chunk.index_at[channel_id] = self._at
            MessageIndex(channel_id, [(int(t), int(o)) for t, o in entries]).write(self._out)
        chunk.index_end = self._at

    def close(self) -> bytes:
        """All bytes."""
        found, out = self._found, self._out
        DataEnd(0).write(out)
        start = self._at
        self._group(Opcode.SCHEMA, found.schemas.values())
        self._group(Opcode.CHANNEL, found.channels.values())
        self._group(Opcode.STATISTICS, [self._statistics()])
        self._group(Opcode.CHUNK_INDEX, (self._chunk_index(chunk) for chunk in found.chunks))
        self._group(
            Opcode.METADATA_INDEX,
            (
                MetadataIndex(length=length, offset=offset, name=record.name)
                for record, (offset, length) in zip(found.metadata, found.metadata_at, strict=True)
            ),
        )
        offsets = self._at
        for group in self._groups:
            group.write(out)
        Footer(start, offsets, 0).write(out)
        return bytes(out.end()) + MAGIC

    def _group(self, opcode: Opcode, records: Iterable[_Record]) -> None:
        start = self._at
        for record in records:
            record.write(self._out)
        if self._at > start:
            self._groups.append(SummaryOffset(opcode, start, self._at - start))

    def _chunk_index(self, chunk: ChunkRef) -> ChunkIndex:
        self._file.seek(chunk.offset)
        start_ns, end_ns, uncompressed, _crc, name_bytes = _CHUNK.unpack(self._file.read(_CHUNK.size))
        compression = self._file.read(name_bytes).decode()
        return ChunkIndex(
            chunk_start_offset=chunk.start,
            chunk_length=HEADER_BYTES + chunk.length,
            compression=compression,
            compressed_size=chunk.length - _CHUNK.size - name_bytes - 8,
            message_start_time=start_ns,
            message_end_time=end_ns,
            message_index_length=max(0, chunk.index_end - chunk.end),
            message_index_offsets=dict(chunk.index_at),
            uncompressed_size=uncompressed,
        )

    def _statistics(self) -> Statistics:
        found = self._found
        counts: dict[int, int] = {}
        first, last = [], []
        for chunk in found.chunks:
            for channel_id, entries in chunk.entries.items():
                counts[channel_id] = counts.get(channel_id, 0) + len(entries)
                times = np.asarray(entries["t_ns"])
                first.append(int(times.min()))
                last.append(int(times.max()))
        for channel_id, loose in found.loose.items():
            counts[channel_id] = counts.get(channel_id, 0) + len(loose)
            first.append(min(t for t, _, _ in loose))
            last.append(max(t for t, _, _ in loose))
        self.messages = sum(counts.values())
        return Statistics(
            attachment_count=0,
            channel_count=len(found.channels),
            channel_message_counts=counts,
            chunk_count=len(found.chunks),
            message_count=self.messages,
            message_end_time=max(last, default=0),
            message_start_time=min(first, default=0),
            metadata_count=len(found.metadata),
            schema_count=len(found.schemas),
        )
