"""The motions of the studies over the API: listed by name, read whole, never by path."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from fastapi import FastAPI
from fastapi.testclient import TestClient

from robot_sim.arms.tomato import tomato_arm
from robot_sim.arms.urdf_writer import ArmModel, limbs_of, write_urdf
from robot_sim.planner.shapes import sphere
from robot_sim.studies.motion_file import write_motion
from server.api import motions, problems


def client(folder: Path) -> TestClient:
    app = FastAPI()
    app.state.studies = folder
    problems.install(app)
    app.include_router(motions.router)
    return TestClient(app)


def test_a_motion_is_listed_and_read(tmp_path: Path) -> None:
    chain = tomato_arm().chain
    q = np.linspace(0.0, 0.3, 4)[:, None] * np.ones(5)
    urdf = write_urdf(ArmModel(chain, limbs_of(chain, 0.03), ()))
    solids = [(sphere((0.1, 0.2, 0.3), 0.05), (1.0, 0.5, 0.25, 0.5))]
    write_motion(tmp_path / "tomato.mcap", urdf, chain, np.arange(4) * 0.1, q, solids=solids)
    (tmp_path / "not a name.mcap").write_bytes(b"")
    api = client(tmp_path)
    assert [m["id"] for m in api.get("/motions").json()] == ["tomato"]
    m = api.get("/motions/tomato").json()
    assert m["urdf"] == urdf and m["joint_names"] == [j.name for j in chain.joints]
    np.testing.assert_allclose(m["q"], q, atol=1e-6)
    np.testing.assert_allclose(m["path"], chain.forward(q)[:, :3, 3], atol=1e-5)
    (volume,) = m["volumes"]
    assert (volume["kind"], volume["xyz_m"], volume["rgba"]) == ("sphere", [0.1, 0.2, 0.3], [1.0, 0.5, 0.25, 0.5])


def test_unknown_names_paths_and_damaged_files_are_refused(tmp_path: Path) -> None:
    folder = tmp_path / "studies"
    assert client(folder).get("/motions").json() == []
    folder.mkdir()
    (tmp_path / "secret.mcap").write_bytes(b"secret")
    (folder / "broken.mcap").write_bytes(b"no recording")
    api = client(folder)
    for name in ("nothing", "..%2Fsecret", "%2e%2e", "a" * 300):
        answer = api.get(f"/motions/{name}")
        assert answer.status_code == 404, name
    assert "broken" in api.get("/motions/nothing").json()["detail"]
    damaged = api.get("/motions/broken")
    assert damaged.status_code == 409 and "damaged" in damaged.json()["detail"]
