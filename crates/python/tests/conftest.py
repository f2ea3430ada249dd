import pathlib
import subprocess
import sys
import threading
import time

import pytest

RECIPES = pathlib.Path(__file__).resolve().parents[3] / "data" / "recipes"


@pytest.fixture
def recipes():
    """Folder with the recipes of the project."""
    return RECIPES


@pytest.fixture
def command():
    """Runs the `isochore` command that was installed with the package."""

    def start(*arguments):
        return subprocess.run(
            [sys.executable, "-m", "isochore", *map(str, arguments)], capture_output=True, text=True, check=False
        )

    return start


@pytest.fixture
def recipe():
    """A small recipe as a dictionary: a ball pressed into another."""
    return {
        "recipe": 1,
        "target": {"shape": {"kind": "icosphere", "radius": 1.0, "subdivisions": 4}},
        "tools": {"ball": {"shape": {"kind": "sphere", "radius": 0.4}, "support": 0.3}},
        "stroke": [{"kind": "move", "tool": "ball", "keys": [{"at": [0, 0, 1.8]}, {"at": [0, 0, 1.0]}]}],
    }


@pytest.fixture
def long_recipe(recipe):
    """A recipe that takes minutes."""
    target = {"shape": {"kind": "icosphere", "radius": 1.0, "subdivisions": 8}}
    return {**recipe, "target": target, "integrate": {"step": 1e-4}}


@pytest.fixture
def ticks():
    """A list that another thread appends to whenever it runs.

    The switch interval is so long that the interpreter never preempts a thread. The other thread runs only if a call releases the
    interpreter's lock.
    """
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
