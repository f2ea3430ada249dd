import numpy as np
import pytest

import isochore


@pytest.fixture
def ball():
    shape = {"kind": "icosphere", "radius": 1.0, "subdivisions": 5}
    return isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh


@pytest.fixture
def brush():
    return isochore.Tool({"shape": {"kind": "sphere", "radius": 0.2}, "support": 0.3}, name="brush")


def stroke(session, brush, **options):
    session.begin_stroke(brush, **options)
    for step in range(6):
        session.move_to([0.1 * step, 0, 1.2 - 0.04 * step], time=step / 60)
    return session.end_stroke()


def test_replaying_the_log_gives_the_same_bits(ball, brush):
    session = isochore.Session(ball, lock=False)
    receipt = stroke(session, brush, refine=False)
    assert receipt["moves"] == 5 and receipt["touched_vertices"] > 100 and receipt["inserted_vertices"] == 0
    log = {**session.log(), "refine": {"enabled": False}}
    assert list(log["tools"]) == ["brush"]
    again = isochore.run(log, meshes={"target": ball})
    exported, vertices = session.export()
    assert np.array_equal(again.mesh.positions, exported.positions)
    assert np.array_equal(vertices, np.arange(len(ball.positions)))
    points, _ = isochore.run_points(log, ball.positions, meshes={"target": ball})
    assert np.array_equal(points, exported.positions)


def test_log_keeps_keys_as_given(ball, brush):
    session = isochore.Session(ball)
    session.begin_stroke(brush)
    session.move_to([0, 0, 1.2])
    session.move_to([0, 0, 1.1], rotate=[0, 0, 2, 30])
    session.end_stroke()
    first, second = session.log()["stroke"][0]["keys"]
    assert first == {"at": [0, 0, 1.2]}
    assert second == {"at": [0, 0, 1.1], "rotate": [0, 0, 2, 30]}


def test_removed_vertices_are_mapped_to_the_merged_ones(ball, brush):
    session = isochore.Session(ball)
    before = np.arange(len(ball.positions))
    assert np.array_equal(session.vertex_map(), before)
    assert stroke(session, brush, longest_edge=0.5)["removed_vertices"] > 0
    exported, remaining = session.export()
    now = session.vertex_map()
    removed = np.setdiff1d(before, remaining)
    assert len(removed) > 0 and np.array_equal(np.flatnonzero(now != before), removed)
    assert np.isin(now, remaining).all()
    assert session.undo() and np.array_equal(session.vertex_map(), before)


def test_volume_changes_add_up(ball, brush):
    session = isochore.Session(ball, lock=False)
    receipt = stroke(session, brush)
    assert receipt["inserted_vertices"] > 0
    volume = receipt["volume"]
    exported, _ = session.export()
    change = volume["flow"] + volume["splits"] + volume["remeshing"]
    assert exported.is_closed
    assert exported.volume - ball.volume == pytest.approx(change, abs=volume["rounding"] + 1e-14)
    assert session.volume == pytest.approx(exported.volume, abs=1e-13)


def test_the_lock_restores_the_volume(ball, brush):
    session = isochore.Session(ball)
    receipt = stroke(session, brush)
    assert receipt["lock_max_shift"] > 0 and receipt["lock_skipped"] is None
    # Far from the surface, the tool moves nothing.
    session.begin_stroke(brush)
    assert session.is_stroke_under_way
    session.move_to([9, 0, 0])
    session.move_to([9, 0, 1])
    assert session.end_stroke()["lock_skipped"] == "no_hold" and not session.is_stroke_under_way
    assert stroke(isochore.Session(ball, lock=False), brush)["lock_skipped"] == "off"
    locked, _ = session.export()
    assert locked.volume == pytest.approx(ball.volume, rel=1e-13)
    # The buffers show the locked positions, which differ from those of the flow alone.
    unlocked, vertices = session.export(lock=False)
    rows = dict(zip(session.vertices_of_render_vertices(), session.positions))
    shown = np.array([rows[vertex] for vertex in vertices])
    del rows
    assert np.array_equal(shown, locked.positions.astype(np.float32))
    assert not np.array_equal(unlocked.positions, locked.positions)


def test_undo_and_redo_are_exact(ball, brush):
    session = isochore.Session(ball)
    stroke(session, brush)
    done = session.positions.copy(), session.triangles.copy(), session.normals.copy()
    assert session.undo() and not session.undo()
    assert np.array_equal(session.positions, ball.positions.astype(np.float32))
    assert session.history["redoable"] == 1
    assert session.redo()
    assert all(np.array_equal(*pair) for pair in zip(done, [session.positions, session.triangles, session.normals]))
    session.begin_stroke(brush)
    session.move_to([0, 0, 1.2])
    session.move_to([0, 0, 1.0])
    assert sum(session.moved_volume) > 0
    session.cancel_stroke()
    assert np.array_equal(session.positions, done[0])


def test_changes_keep_copies_up_to_date(ball, brush):
    session = isochore.Session(ball)
    copies = {}

    def follow():
        changes = session.take_changes()
        for name in ["positions", "normals", "triangles"]:
            buffer = getattr(session, name)
            copy = np.zeros_like(buffer)
            old = copies.get(name, copy)
            rows = min(len(old), len(copy))
            copy[:rows] = old[:rows]
            for start, end in changes[name]:
                copy[start:end] = buffer[start:end]
            assert np.array_equal(copy, buffer)
            copies[name] = copy
        return changes

    assert follow()["positions"] == [(0, len(ball.positions))]
    session.begin_stroke(brush)
    for step in range(6):
        session.move_to([0.1 * step, 0, 1.2 - 0.04 * step])
        # The first pose moves nothing.
        assert (follow()["positions"] == []) == (step == 0)
    session.end_stroke()
    session.undo()
    follow()


def test_views_prevent_changes(ball, brush):
    session = isochore.Session(ball)
    positions = session.positions
    part = positions[3:5]
    with pytest.raises(ValueError):
        positions[0] = 0
    with pytest.raises(BufferError, match="still held"):
        session.begin_stroke(brush)
    del positions
    with pytest.raises(BufferError):
        session.begin_stroke(brush)
    del part
    session.begin_stroke(brush)
    session.cancel_stroke()


def test_queries(ball, brush):
    session = isochore.Session(ball)
    hit = session.pick([0, 0, 5], [0, 0, -1])
    assert hit["point"] == pytest.approx([0, 0, 1], abs=1e-3) and hit["distance"] == pytest.approx(4, abs=1e-3)
    assert np.dot(hit["weights"], ball.positions[list(hit["vertices"])]) == pytest.approx(hit["point"], abs=1e-6)
    assert session.pick([0, 0, 5], [0, 0, 1]) is None
    assert session.closest_point([0, 3, 0])["point"] == pytest.approx([0, 1, 0], abs=2e-2)
    reach = session.vertices_in_reach(brush, [0, 0, 1.2])
    # Exactly the vertices whose distance from the center is less than radius plus support.
    expected = np.flatnonzero(np.linalg.norm(ball.positions - [0, 0, 1.2], axis=1) < 0.5)
    assert np.array_equal(reach, expected)
    points, shifts = session.preview(brush, [0, 0, 1.2], [0, 0, 1.1])
    assert len(points) > 50 and np.all(np.linalg.norm(shifts, axis=1) > 0)
    center = np.argmin(np.linalg.norm(points - [0, 0, 1.2], axis=1))
    assert shifts[center] == pytest.approx([0, 0, -0.1], abs=1e-12)
    _, turned = session.preview(brush, [0, 0, 1.2], [0, 0, 1.1], end_rotate=[0, 0, 1, 30])
    # Points in the core rotate about the axis of the tool while they move down.
    assert turned[center][2] == pytest.approx(-0.1, abs=1e-12) and np.any(turned[center][:2] != 0)
    assert np.array_equal(session.vertices_of_render_vertices(), np.arange(len(ball.positions)))


def test_rejects_invalid_calls(ball, brush):
    session = isochore.Session(ball)
    for call in [session.end_stroke, session.cancel_stroke, lambda: session.move_to([0, 0, 0])]:
        with pytest.raises(isochore.Error, match="no stroke"):
            call()
    session.begin_stroke(brush)
    with pytest.raises(isochore.Error, match="under way"):
        session.undo()
    with pytest.raises(ValueError, match="at: is NaN"):
        session.move_to([0, 0, float("nan")])
    with pytest.raises(ValueError, match="rotate: has length zero"):
        session.move_to([0, 0, 0], rotate=[0, 0, 0, 90])
    session.cancel_stroke()
    with pytest.raises(isochore.Error):
        isochore.Session(isochore.Mesh(np.eye(3), [[0, 1, 2], [0, 1, 2]]))
    with pytest.raises(isochore.RecipeError, match="support"):
        isochore.Tool({"shape": {"kind": "sphere", "radius": 0.2}})


def test_seams_stay_closed(brush):
    # A box whose faces have separate texture coordinates, so that every edge of the box is a seam.
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    uvs = np.array([[square[0] + [2 * f, 0], square[i] + [2 * f, 0], square[i + 1] + [2 * f, 0]] for f in range(6) for i in (1, 2)])
    session = isochore.Session(isochore.Mesh(corners, triangles, uvs=[uvs]))
    session.begin_stroke(brush, longest_edge=0.1)
    for step in range(4):
        session.move_to([1.2 - 0.05 * step, 0.9, 0.8])
    session.end_stroke()
    exported, _ = session.export()
    assert exported.is_closed and len(exported.triangles) > 100
    # No triangle spans the textures of two faces.
    assert np.all(np.ptp(np.floor(exported.uvs[0][:, :, 0].clip(1e-9) / 2), axis=1) == 0)
    across = session.uvs[0].shape[0] - len(np.unique(session.vertices_of_render_vertices()))
    assert across >= 24 - 8
