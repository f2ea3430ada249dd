"""Other threads of Python run while isochore works."""

import itertools
import sys
import threading
import time

import numpy as np
import pytest

import isochore


@pytest.fixture(scope="module")
def ball():
    """160,000 vertices: each call takes some milliseconds."""
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


@pytest.fixture
def ticks():
    """A list that another thread adds to whenever it runs. It is never given its turn, but has to be let in."""
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(1)
            time.sleep(1e-4)

    interval = sys.getswitchinterval()
    thread = threading.Thread(target=tick)
    thread.start()
    sys.setswitchinterval(1e3)
    yield ticks
    sys.setswitchinterval(interval)
    stop.set()
    thread.join()


CALLS = {
    "is_closed": lambda ball, session, brush: ball.is_closed,
    "volume": lambda ball, session, brush: ball.volume,
    "area": lambda ball, session, brush: ball.area,
    "bounds": lambda ball, session, brush: ball.bounds,
    "skin": lambda ball, session, brush: ball.skin,
    "welded": lambda ball, session, brush: ball.welded(),
    "split_at_seams": lambda ball, session, brush: ball.split_at_seams(),
    "to_bytes": lambda ball, session, brush: ball.to_bytes("ply"),
    "triangles": lambda ball, session, brush: isochore.Mesh(ball.positions, ball.triangles),
    "origins": lambda ball, session, brush: session.origins(),
    "vertices_of_render_vertices": lambda ball, session, brush: session.vertices_of_render_vertices(),
    "vertices_in_reach": lambda ball, session, brush: session.vertices_in_reach(brush, [0, 0, 0]),
    "vertex_map": lambda ball, session, brush: session.vertex_map(),
    "preview": lambda ball, session, brush: session.preview(brush, [0, 0, 0], [0, 0, 0.1], per_side=24),
    "export": lambda ball, session, brush: session.export(),
    "open": lambda ball, session, brush: isochore.Session(ball),
}


@pytest.mark.parametrize("name", CALLS)
def test_other_threads_are_let_in(ball, session, brush, ticks, name):
    before = len(ticks)
    # One call may be over before the system wakes the other thread.
    for _ in itertools.takewhile(lambda _: len(ticks) == before, range(100)):
        CALLS[name](ball, session, brush)
    assert len(ticks) > before


def test_a_busy_session_holds_up_its_own_callers_alone(ball, brush, ticks):
    session = isochore.Session(ball)
    session.begin_stroke(brush, refine=False)
    session.move_to([0, 0, 0])
    mover = threading.Thread(target=session.move_to, args=([0, 0, 0.3],))
    mover.start()
    # Until the move is done, this waits for the session.
    before = len(ticks)
    while session.moved_volume == (0.0, 0.0):
        time.sleep(0)
    assert len(ticks) > before
    mover.join()
    session.cancel_stroke()
