"""Remeshing of meshes and in sessions."""

import isochore
import numpy as np
import pytest


def ball(subdivisions=4):
    shape = {"kind": "icosphere", "radius": 1.0, "subdivisions": subdivisions}
    return isochore.run({"recipe": 1, "target": {"shape": shape}}).mesh


def test_remesh_of_a_mesh():
    mesh = ball()
    remeshed, receipt = isochore.remesh(mesh, deviation=1e-3)
    assert receipt["triangles_before"] == len(mesh.triangles)
    assert receipt["triangles_after"] == len(remeshed.triangles) < len(mesh.triangles)
    assert abs(remeshed.volume / mesh.volume - 1) < 1e-12
    assert receipt["allowance"] == pytest.approx(1e-3 * np.ptp(mesh.positions, axis=0).max())
    assert receipt["lock_skipped"] is None


def test_remesh_in_a_session_can_be_undone():
    session = isochore.Session(ball())
    before = session.positions.copy()
    receipt = session.remesh(edge_length=0.2)
    assert receipt["triangles_after"] < receipt["triangles_before"]
    assert receipt["undo_bytes"] > 0
    assert session.history["undoable"] == 1
    assert session.undo()
    assert np.array_equal(session.positions, before)


def test_views_prevent_a_remesh():
    session = isochore.Session(ball(2))
    view = session.positions
    with pytest.raises(BufferError):
        session.remesh()
    del view
    session.remesh()


def test_invalid_arguments():
    with pytest.raises(ValueError, match="edge length"):
        isochore.remesh(ball(1), edge_length=-1)
    with pytest.raises(ValueError, match="deviation"):
        isochore.remesh(ball(1), deviation=float("nan"))
    fins = isochore.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0]], [[0, 1, 2], [0, 1, 3], [1, 0, 4]])
    with pytest.raises(isochore.Error):
        isochore.remesh(fins)
