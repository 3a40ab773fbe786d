"""GET /health, GET /state, GET /metrics."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector
from pydantic import BaseModel, Field

from server import wire
from server.api.deps import EngineDep
from server.api.problems import documented
from server.engine.engine import Engine
from server.errors import Refused
from server.stream.hub import Hub
from teleop.software import software_version

router = APIRouter()


class Health(BaseModel):
    """The server is up and its engine steps."""

    status: Literal["ok", "degraded"] = Field("ok", description="degraded: the engine has not stepped for too long")
    version: str
    step_age_s: float = Field(description="time since the last step of the robot [s]")
    source: str | None = Field(description="what is playing")
    fault: str | None = Field(description="why the source gives no frames")


@router.get("/health", tags=["operation"], responses=documented(503))
def read_health(engine: EngineDep) -> Health:
    """200 while the engine runs, 503 when it has stopped; degraded while its last step is too old."""
    if not engine.is_alive():
        raise Refused(503, "the engine has stopped; see the server's log and restart it")
    session = engine.session
    late = engine.step_age_s > engine.settings.engine.degraded_s
    return Health(
        status="degraded" if late else "ok",
        step_age_s=round(engine.step_age_s, 3),
        version=software_version(),
        source=session.name if session else None,
        fault=session.fault if session else None,
    )


@router.get("/state", tags=["operation"], responses=documented(503))
def read_state(engine: EngineDep) -> wire.State:
    """The same state as on the stream, at this moment."""
    latest = engine.publisher.latest()
    if latest is None:
        raise Refused(503, "the engine has not made its first step yet; ask again")
    return latest


class EngineMetrics(Collector):
    """Prometheus' view of one engine and its clients."""

    def __init__(self, engine: Engine, hub: Hub) -> None:
        self._engine = engine
        self._hub = hub

    def collect(self) -> list[Metric]:
        """Counters and gauges, read at this moment."""
        latency = GaugeMetricFamily(
            "teleop_latency_ms", "Latency per stage over the last frames [ms]", labels=["stage", "quantile"]
        )
        for stage, row in self._engine.ledger.table().items():
            latency.add_metric([stage, "0.5"], row.p50)
            latency.add_metric([stage, "0.95"], row.p95)
        robot = self._engine.publisher.latest()
        estop = GaugeMetricFamily("teleop_estop", "Emergency stop latched (0 or 1)")
        estop.add_metric([], float(robot.robot.estop) if robot else 0.0)
        return [
            CounterMetricFamily("teleop_frames", "Frames taken by the engine", value=self._engine.frames),
            CounterMetricFamily("teleop_frames_dropped", "Frames replaced by a newer one", value=self._engine.dropped),
            GaugeMetricFamily("teleop_clients", "Clients of the stream", value=self._hub.count),
            estop,
            latency,
        ]


def metrics_router(engine: Engine, hub: Hub) -> APIRouter:
    """GET /metrics, outside /api/v1, where Prometheus looks for it."""
    registry = CollectorRegistry()
    registry.register(EngineMetrics(engine, hub))
    routes = APIRouter()

    @routes.get("/metrics", tags=["operation"], response_class=Response)
    def read_metrics() -> Response:
        """Prometheus text format."""
        return Response(generate_latest(registry), media_type=CONTENT_TYPE_LATEST)

    return routes
