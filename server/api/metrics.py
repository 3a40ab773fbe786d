"""GET /metrics: Prometheus' view of the engine, its clients, the event loop, requests, recording and process."""

from __future__ import annotations

import time
from collections import Counter, defaultdict

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.gc_collector import GCCollector
from prometheus_client.metrics_core import Metric
from prometheus_client.platform_collector import PlatformCollector
from prometheus_client.process_collector import ProcessCollector
from prometheus_client.registry import Collector
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.access.desk import Desk
from server.engine.engine import Engine
from server.jobs import Jobs
from server.loop_lag import LoopLag
from server.stream.hub import Hub


class Requests:
    """Pure ASGI: counts HTTP requests by method and status, and the seconds they took."""

    def __init__(self, app: ASGIApp, *, counts: Counter[tuple[str, int]], seconds: dict[str, float]) -> None:
        self._app = app
        self._counts = counts
        self._seconds = seconds

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on and count."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begin_s = time.monotonic()

        async def counted(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._counts[scope["method"], message["status"]] += 1
                self._seconds[scope["method"]] += time.monotonic() - begin_s
            await send(message)

        await self._app(scope, receive, counted)


class EngineMetrics(Collector):
    """Counters and gauges of one engine and its clients, read when asked."""

    def __init__(self, engine: Engine, hub: Hub, desk: Desk, jobs: Jobs, lag: LoopLag) -> None:
        self._engine = engine
        self._hub = hub
        self._desk = desk
        self._jobs = jobs
        self._lag = lag
        self.requests: Counter[tuple[str, int]] = Counter()
        self.seconds: dict[str, float] = defaultdict(float)

    def collect(self) -> list[Metric]:
        """All families."""
        return [*self._of_engine(), *self._of_clients(), *self._of_requests()]

    def _of_engine(self) -> list[Metric]:
        engine = self._engine
        latency = GaugeMetricFamily(
            "teleop_latency_ms", "Latency per stage over the last frames [ms]", labels=["stage", "quantile"]
        )
        for stage, row in engine.ledger.table().items():
            latency.add_metric([stage, "0.5"], row.p50)
            latency.add_metric([stage, "0.95"], row.p95)
        latest, session = engine.publisher.latest(), engine.session
        robot = latest.robot if latest else None
        return [
            latency,
            CounterMetricFamily("teleop_frames", "Frames taken by the engine", value=engine.frames),
            CounterMetricFamily("teleop_frames_dropped", "Frames replaced by a newer one", value=engine.dropped),
            _gauge("teleop_step_age_seconds", "Time since the engine's last step [s]", engine.step_age_s),
            _gauge("teleop_estop", "Emergency stop latched (0 or 1)", robot is not None and robot.estop),
            _gauge("teleop_engaged", "An operator is engaged (0 or 1)", latest is not None and latest.engaged),
            _gauge("teleop_drive_m_s", "Speed of the chassis [m/s]", robot.drive_m_s if robot else 0.0),
            _gauge("teleop_source_failed", "The source gives no frames (0 or 1)", bool(session and session.fault)),
            _gauge("teleop_recording", "A recording is being made (0 or 1)", bool(session and session.recording_now)),
        ]

    def _of_clients(self) -> list[Metric]:
        hub, lease = self._hub, self._desk.lease
        lag = GaugeMetricFamily(
            "teleop_loop_lag_seconds", "Lateness of the event loop over the last minute [s]", labels=["quantile"]
        )
        quantiles = (0.5, 0.95, 0.99)
        for quantile, value in zip(quantiles, self._lag.quantiles_s(*quantiles), strict=True):
            lag.add_metric([str(quantile)], value)
        jobs = GaugeMetricFamily("teleop_jobs", "Long jobs by status", labels=["status"])
        for status, count in Counter(job.status for job in self._jobs.all()).items():
            jobs.add_metric([status], count)
        return [
            lag,
            jobs,
            _gauge("teleop_clients", "Clients of the stream", hub.count),
            CounterMetricFamily("teleop_messages_replaced", "Messages a newer one replaced", value=hub.replaced),
            CounterMetricFamily("teleop_clients_stalled", "Clients closed for reading nothing", value=hub.overflowed),
            _gauge("teleop_lease_held", "Somebody holds the lease (0 or 1)", lease.holder is not None),
            _gauge("teleop_lease_requests", "Clients that wait for the lease", len(lease.requests)),
        ]

    def _of_requests(self) -> list[Metric]:
        requests = CounterMetricFamily("teleop_http_requests", "HTTP requests", labels=["method", "status"])
        for (method, status), count in list(self.requests.items()):
            requests.add_metric([method, str(status)], count)
        seconds = CounterMetricFamily("teleop_http_seconds", "Time until HTTP answers began [s]", labels=["method"])
        for method, spent_s in list(self.seconds.items()):
            seconds.add_metric([method], spent_s)
        refused = CounterMetricFamily("teleop_refused", "Requests and websockets refused", labels=["status"])
        for status, count in list(self._desk.refused.items()):
            refused.add_metric([str(status)], count)
        return [requests, seconds, refused]


def metrics_router(metrics: EngineMetrics) -> APIRouter:
    """GET /metrics, outside /api/v1, where Prometheus looks for it."""
    registry = CollectorRegistry()
    registry.register(metrics)
    ProcessCollector(registry=registry)
    PlatformCollector(registry=registry)
    GCCollector(registry=registry)
    routes = APIRouter()

    @routes.get("/metrics", tags=["operation"], response_class=Response)
    def read_metrics() -> Response:
        """Prometheus text format."""
        return Response(generate_latest(registry), media_type=CONTENT_TYPE_LATEST)

    return routes


def _gauge(name: str, about: str, value: float) -> GaugeMetricFamily:
    return GaugeMetricFamily(name, about, value=float(value))
