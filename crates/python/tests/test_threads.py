"""Other Python threads run while isochore works."""

import threading
import time

import numpy as np
import pytest

import isochore

GUARD = 300.0
"""Seconds before a test gives up. No result depends on it unless no other thread ever runs."""


@pytest.fixture(scope="module")
def ball():
    """160,000 vertices, so that most calls take milliseconds."""
    shape = {"kind": "icosphere", "radius": 1.0, "subdivisions": 7}
    mesh = isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh
    corners = mesh.positions[mesh.triangles]
    joints = np.arange(2 * len(mesh.positions)).reshape(-1, 2) % 7
    return isochore.Mesh(
        mesh.positions, mesh.triangles, uvs=[corners[:, :, :2]], normals=corners, skin=(joints, np.ones(joints.shape))
    )


@pytest.fixture(scope="module")
def session(ball):
    return isochore.Session(ball)


@pytest.fixture(scope="module")
def brush():
    return isochore.Tool({"shape": {"kind": "sphere", "radius": 2.0}, "support": 0.5})


@pytest.fixture(scope="module")
def indices(ball):
    """Triangles as the integers that isochore reads, so that NumPy has nothing to convert without the lock."""
    return ball.triangles.astype(np.int64)


def let_in(call, ticks, times=1):
    """Whether another thread ran this many times during a single call, which is repeated until it did.

    The system may wake the other thread too late for a single call, above all on a busy machine. A call that holds the
    interpreter's lock never lets it run, however often it is repeated.
    """
    deadline = time.monotonic() + GUARD
    while time.monotonic() < deadline:
        before = len(ticks)
        call()
        if len(ticks) >= before + times:
            return True
    return False


CALLS = {
    "is_closed": lambda ball, indices, session, brush: ball.is_closed,
    "volume": lambda ball, indices, session, brush: ball.volume,
    "area": lambda ball, indices, session, brush: ball.area,
    "bounds": lambda ball, indices, session, brush: ball.bounds,
    "skin": lambda ball, indices, session, brush: ball.skin,
    "welded": lambda ball, indices, session, brush: ball.welded(),
    "split_at_seams": lambda ball, indices, session, brush: ball.split_at_seams(),
    "to_bytes": lambda ball, indices, session, brush: ball.to_bytes("ply"),
    "triangles": lambda ball, indices, session, brush: isochore.Mesh(ball.positions, indices),
    "origins": lambda ball, indices, session, brush: session.origins(),
    "vertices_of_render_vertices": lambda ball, indices, session, brush: session.vertices_of_render_vertices(),
    "vertices_in_reach": lambda ball, indices, session, brush: session.vertices_in_reach(brush, [0, 0, 0]),
    "vertex_map": lambda ball, indices, session, brush: session.vertex_map(),
    "preview": lambda ball, indices, session, brush: session.preview(brush, [0, 0, 0], [0, 0, 0.1], per_side=24),
    "export": lambda ball, indices, session, brush: session.export(),
    "open": lambda ball, indices, session, brush: isochore.Session(ball),
}


@pytest.mark.parametrize("name", CALLS)
def test_calls_let_other_threads_run(ball, indices, session, brush, ticks, name):
    assert let_in(lambda: CALLS[name](ball, indices, session, brush), ticks)


def test_a_busy_session_blocks_only_its_own_callers(ball, brush, ticks):
    session = isochore.Session(ball)
    session.begin_stroke(brush, refine=False)
    stop = threading.Event()

    def move():
        while not stop.is_set():
            session.move_to([0, 0, 0])
            session.move_to([0, 0, 0.3])

    mover = threading.Thread(target=move)
    mover.start()
    try:
        # The query itself takes no time, but waits for the move that is in progress.
        assert let_in(lambda: session.is_stroke_under_way, ticks, times=5)
    finally:
        stop.set()
        mover.join()
    session.cancel_stroke()


def test_progress_does_not_stop_other_threads(long_recipe, ticks):
    before = len(ticks)
    # The work takes minutes, and ends when the other thread has run ten times meanwhile.
    with pytest.raises(isochore.Cancelled):
        isochore.run(long_recipe, progress=lambda stage, done: len(ticks) < before + 10)
