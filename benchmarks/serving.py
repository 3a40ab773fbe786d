"""What the benchmarks of the server share: its metrics, and viewers in a process of their own."""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import socket
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection

import httpx
from prometheus_client.parser import text_string_to_metric_families
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed


def metric(port: int, name: str, **labels: str) -> float:
    """One number of /metrics. Raises KeyError when it is not there."""
    text = httpx.get(f"http://127.0.0.1:{port}/metrics", timeout=10).text
    for family in text_string_to_metric_families(text):
        for sample in family.samples:
            if sample.name == name and labels.items() <= sample.labels.items():
                return float(sample.value)
    raise KeyError(name)


@dataclass(frozen=True, slots=True)
class Seen:
    """What one viewer received. gaps_ms: between the server's stamps of states that followed each other."""

    states: int
    pictures: int
    gaps_ms: tuple[float, ...]


async def _look(port: int, seconds: float) -> Seen:
    states = pictures = 0
    gaps, last_seq, last_t = [], -1, 0.0
    async with connect(f"ws://127.0.0.1:{port}/api/v1/stream", max_size=None) as stream:
        await stream.send(json.dumps({"type": "view", "image": "depth", "head": False}))
        end_s = time.monotonic() + seconds
        while time.monotonic() < end_s:
            message = await stream.recv()
            if isinstance(message, bytes):
                pictures += 1
                continue
            if not message.startswith('{"type":"state"'):
                continue
            states += 1
            body = json.loads(message[: message.index(',"source"')] + "}")
            if body["seq"] == last_seq + 1:
                gaps.append((body["t"] - last_t) * 1e3)
            last_seq, last_t = body["seq"], body["t"]
            await stream.send(json.dumps({"type": "painted", "seq": body["seq"]}))
    return Seen(states, pictures, tuple(gaps))


async def _come_and_go(port: int, seconds: float) -> Seen:
    """A viewer that connects anew every second, as a bad network makes it."""
    end_s = time.monotonic() + seconds
    visits = 0
    while (left_s := end_s - time.monotonic()) > 0.5:
        try:
            await _look(port, min(1.0, left_s))
        except (OSError, ConnectionClosed):
            await asyncio.sleep(0.2)
        visits += 1
    return Seen(visits, 0, ())


def _work(port: int, seconds: float, steady: int, restless: int, answer: Connection) -> None:
    async def all_of_them() -> list[Seen]:
        work = [_look(port, seconds) for _ in range(steady)] + [_come_and_go(port, seconds) for _ in range(restless)]
        return await asyncio.gather(*work)

    answer.send(asyncio.run(all_of_them()))


@contextmanager
def viewers(port: int, seconds: float, steady: int, restless: int = 0) -> Iterator[Connection]:
    """Viewers in another process; receive the list of what they have Seen from the connection when they are done."""
    mine, theirs = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=_work, args=(port, seconds, steady, restless, theirs))
    process.start()
    try:
        yield mine
        process.join(30)
    finally:
        if process.is_alive():
            process.terminate()
        process.join()


@contextmanager
def stalled_viewer(port: int) -> Iterator[None]:
    """A client that asks for everything and reads nothing."""
    with closing(socket.socket()) as client:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        client.connect(("127.0.0.1", port))
        client.sendall(
            f"GET /api/v1/stream HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        yield


def quantile(values: list[float], q: float) -> float:
    """Nearest rank; NaN without values."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(q * len(ordered)))] if ordered else float("nan")
