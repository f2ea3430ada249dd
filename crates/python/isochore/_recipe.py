"""Recipes and the files that they name."""

import json
import os
import pathlib
from collections.abc import Mapping
from typing import NamedTuple

from isochore._json import to_json
from isochore._native import LoadedRecipe, Mesh


class Result(NamedTuple):
    """Result of a recipe."""

    mesh: Mesh
    rest: Mesh
    report: dict


def run(recipe, *, meshes=None, settings=(), progress=None):
    """Deforms the target of a recipe. See the type stubs for the arguments."""
    loaded, folder = parse(recipe, settings)
    mesh, rest, report = loaded.replay(folder, meshes or {}, progress)
    return Result(mesh, rest, json.loads(report))


def run_points(recipe, points, *, meshes=None, settings=(), progress=None):
    """Advects points along the strokes of a recipe. See the type stubs for the arguments."""
    loaded, folder = parse(recipe, settings)
    return loaded.replay_points(points, folder, meshes or {}, progress)


def parse(recipe, settings):
    """Parses a recipe. Returns it with the folder that its file names are relative to."""
    if isinstance(recipe, Mapping):
        folder, text, is_json = pathlib.Path(), to_json(recipe), True
    else:
        path = pathlib.Path(os.fspath(recipe))
        folder, text, is_json = path.parent, path.read_text(encoding="utf-8"), path.suffix.lower() == ".json"
    return LoadedRecipe(text, is_json, setting_texts(settings)), folder


def setting_texts(settings):
    """Converts settings, which may be a mapping, to strings KEY=VALUE."""
    if isinstance(settings, Mapping):
        return [f"{key}={to_json(value)}" for key, value in settings.items()]
    return [str(setting) for setting in settings]
