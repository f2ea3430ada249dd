"""The operator in a window. As a Python module Blender has no window, so the tests play the part of Blender."""

import itertools
import time
from types import SimpleNamespace

import bpy
import isochore
import numpy as np
import pytest
from isochore_blender import OBJECT_OT_isochore_deform as Operator
from isochore_blender.deformation import Deformation
from isochore_blender.surface import read

RECIPE = {
    "recipe": 1,
    "target": {"mesh": "unused.obj"},
    "tools": {"ball": {"shape": {"kind": "sphere", "radius": 0.5}, "support": 0.4}},
    "stroke": [{"kind": "move", "tool": "ball", "keys": [{"at": [0, 0, 1.4]}, {"at": [0, 0, 0.9]}]}],
    "refine": {"max_edge": 0.1},
}

LONG = {**RECIPE, "integrate": {"step": 2e-6}, "refine": {"max_edge": 0.02}}
"""A recipe that takes minutes."""

GUARD = 600.0
"""Seconds before a test gives up on an operator that does not end."""


class Window:
    """The operator, its context, and the objects that it reaches through the context."""

    invoke, execute, modal, cancel = Operator.invoke, Operator.execute, Operator.modal, Operator.cancel
    _finish, _fail = Operator._finish, Operator._fail
    text, deformation, is_interactive = "recipe", None, False

    def __init__(self, target, recipe):
        self.object, self.window, self.recipe = target, None, recipe
        self.reports, self.shown, self.status, self.timers, self.is_shown = [], [], [], 0, False
        self.window_manager = self.workspace = self

    def _recipe(self):
        return self.recipe

    def report(self, kinds, text):
        self.reports.append((*kinds, text))

    def progress_begin(self, low, high):
        self.is_shown = True

    def progress_update(self, done):
        assert self.is_shown
        self.shown.append(done)

    def progress_end(self):
        self.is_shown = False

    def event_timer_add(self, interval, window):
        self.timers += 1
        return "timer"

    def event_timer_remove(self, timer):
        self.timers -= 1

    def modal_handler_add(self, operator):
        assert operator is self

    def status_text_set(self, text):
        self.status.append(text)

    def happen(self, *events):
        """Sends these events and then timer events until the operator ends. Returns its answer."""
        deadline = time.monotonic() + GUARD
        for kind in itertools.chain(events, itertools.repeat("TIMER")):
            answer = self.modal(self, SimpleNamespace(type=kind))
            if answer != {"RUNNING_MODAL"}:
                return answer
            if time.monotonic() > deadline:
                break
            time.sleep(0.01)
        pytest.fail("the operator does not end")


@pytest.fixture
def ball():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    return bpy.context.object


def positions(target):
    return read(target.data.vertices, "co", 3, np.float32)


def test_the_operator_runs_in_the_background(ball):
    window = Window(ball, {**RECIPE, "integrate": {"step": 1e-3}})
    rest = positions(ball)
    assert window.invoke(window, None) == {"RUNNING_MODAL"} and window.timers == 1
    # The mesh changes only when the operator ends.
    assert np.array_equal(positions(ball), rest)
    assert window.happen() == {"FINISHED"}
    assert len(ball.data.polygons) > 1000 and window.timers == 0 and not window.is_shown
    assert window.status[-1] is None and all("Esc" in text for text in window.status[:-1])
    assert window.shown and all(0 <= done <= 1 for done in window.shown)
    [(kind, text)] = window.reports
    assert kind == "INFO" and "triangles" in text

    # A script waits for the same result.
    now = positions(ball)
    again = Deformation(ball_of(rest), {**RECIPE, "integrate": {"step": 1e-3}})
    fractions = []
    again.run(lambda stage, done: fractions.append(done))
    again.finish()
    assert np.array_equal(positions(again.surface.target), now) and all(0 <= done <= 1 for done in fractions)


def ball_of(rest):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    assert np.array_equal(positions(bpy.context.object), rest)
    return bpy.context.object


@pytest.mark.parametrize("closes", [False, True])
def test_the_operator_can_be_stopped(ball, closes):
    window = Window(ball, LONG)
    rest = positions(ball)
    window.invoke(window, None)
    while window.deformation.progress == ("start", 0.0):
        assert not window.deformation.is_done()
        time.sleep(0.01)
    if closes:
        window.cancel(window)
        with pytest.raises(isochore.Cancelled):
            window.deformation.finish()
    else:
        assert window.happen("ESC") == {"CANCELLED"}
        assert window.timers == 0 and not window.is_shown and window.status[-1] is None
    assert np.array_equal(positions(ball), rest) and window.reports == []


def test_errors_in_the_thread_are_reported(ball):
    window = Window(ball, {**RECIPE, "refin": {}})
    window.invoke(window, None)
    assert window.happen() == {"CANCELLED"}
    [(kind, text)] = window.reports
    assert kind == "ERROR" and "refin" in text
