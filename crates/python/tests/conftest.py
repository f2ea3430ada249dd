import pathlib
import subprocess
import sys

import pytest

RECIPES = pathlib.Path(__file__).resolve().parents[3] / "data" / "recipes"


@pytest.fixture
def recipes():
    """The recipes of the project."""
    return RECIPES


@pytest.fixture
def command():
    """Starts the command that was installed with the package."""

    def start(*arguments):
        return subprocess.run(
            [sys.executable, "-m", "isochore", *map(str, arguments)], capture_output=True, text=True, check=False
        )

    return start


@pytest.fixture
def recipe():
    """A small recipe as plain data: a ball pressed into another."""
    return {
        "recipe": 1,
        "target": {"shape": {"kind": "icosphere", "radius": 1.0, "subdivisions": 4}},
        "tools": {"ball": {"shape": {"kind": "sphere", "radius": 0.4}, "support": 0.3}},
        "stroke": [{"kind": "move", "tool": "ball", "keys": [{"at": [0, 0, 1.8]}, {"at": [0, 0, 1.0]}]}],
    }
