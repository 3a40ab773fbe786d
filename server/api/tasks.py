"""Assisted picks: ask for one, look how it stands, confirm its preview, end it; and the fruit there is."""

from __future__ import annotations

from fastapi import APIRouter, Response

from server import wire
from server.api.deps import EngineDep, done
from server.api.models import FruitState, PickOrder
from server.api.problems import documented
from server.engine.hello import fruit_info
from server.errors import Refused

router = APIRouter(tags=["tasks"])


@router.get("/fruits", responses=documented(503))
def list_fruits(engine: EngineDep) -> list[FruitState]:
    """All fruit that the robot knows of."""
    latest = engine.publisher.latest()
    told = {} if latest is None else latest.robot.fruits
    fruits = []
    for fruit in engine.fruits:
        status, _, damaged = told.get(fruit.name, "hanging").partition("+")
        info = fruit_info(fruit).model_dump()
        fruits.append(FruitState(**info, status=status, damaged=damaged == "damaged"))
    return fruits


@router.post("/tasks/pick", status_code=202, responses={200: {"model": wire.TaskState}, **documented(404, 503)})
async def pick(engine: EngineDep, response: Response, order: PickOrder | None = None) -> wire.TaskState:
    """Begin an assisted pick; the answer is the task after the robot's next step.

    What cannot be picked is a task with the status ``refused``, whose reason and detail say what to do. Asking again
    for the fruit that is under way gives that task (200). Without an operator it starts at once, or, with
    ``preview``, when it is confirmed; with one it starts when they close the left fist, and ends when a hand opens.
    """
    order = order or PickOrder(fruit=None, preview=False)
    known = [fruit.name for fruit in engine.fruits]
    if order.fruit is not None and order.fruit not in known:
        near = ", ".join(known[:5]) or "none; a real robot needs somebody who sees the crop"
        raise Refused(404, f"no fruit '{order.fruit}'; GET /api/v1/fruits lists all: {near}", "fruit")
    task, new = await done(engine.pick(order.fruit, order.preview))
    if not new:
        response.status_code = 200
    return task


@router.get("/tasks")
def list_tasks(engine: EngineDep) -> list[wire.TaskState]:
    """Newest first; the last hundred are remembered."""
    return engine.tasks.all()


@router.get("/tasks/{task_id}", responses=documented(404))
def read_task(engine: EngineDep, task_id: str) -> wire.TaskState:
    """One task as it stands."""
    return engine.tasks.find(task_id)


@router.post("/tasks/{task_id}/confirm", responses=documented(404, 409, 503))
async def confirm_task(engine: EngineDep, task_id: str) -> wire.TaskState:
    """Let a previewed pick begin. Confirming twice does no harm; under an operator only their left fist confirms."""
    task = engine.tasks.find(task_id)
    if task.status == "preview" and task.attended:
        raise Refused(409, "an operator is engaged: they confirm with the left fist", "attended")
    if task.ended is not None:
        raise Refused(409, f"the task has ended ({task.status}); ask for a new one", "ended")
    await done(engine.decide_pick(task_id, "confirm"))
    return engine.tasks.find(task_id)


@router.delete("/tasks/{task_id}", responses=documented(404, 503))
async def cancel_task(engine: EngineDep, task_id: str) -> wire.TaskState:
    """End a task; the robot stops where it is. Ending one twice, or one that is over, does no harm."""
    task = engine.tasks.find(task_id)
    if task.ended is None:
        await done(engine.decide_pick(task_id, "cancel"))
    return engine.tasks.find(task_id)
