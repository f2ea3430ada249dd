"""Recipes and the files that they name."""

import csv
import json
import os
import pathlib
from collections.abc import Mapping
from typing import NamedTuple

from isochore._json import to_json
from isochore._native import Error, LoadedRecipe, Mesh


class Result(NamedTuple):
    """Result of a recipe."""

    mesh: Mesh
    rest: Mesh
    report: dict


def run(recipe, *, meshes=None, settings=(), progress=None):
    """Deforms the target of a recipe. See the type stubs for the arguments."""
    loaded, files = _load(recipe, meshes or {}, settings)
    mesh, rest, report = loaded.replay(*files, progress)
    return Result(mesh, rest, json.loads(report))


def run_points(recipe, points, *, meshes=None, settings=(), progress=None):
    """Advects points along the strokes of a recipe. See the type stubs for the arguments."""
    loaded, files = _load(recipe, meshes or {}, settings)
    return loaded.replay_points(points, *files, progress)


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


def _load(recipe, meshes, settings):
    """Parses a recipe and reads its meshes, its curves and the weights of its mask."""
    loaded, folder = parse(recipe, settings)
    found = {name: meshes[name] if name in meshes else Mesh.read(folder / name) for name in loaded.mesh_names}
    curves = {name: [row[:3] for row in _rows(folder / name, (3, 6))] for name in loaded.curve_names}
    weights = None
    if loaded.weights_name is not None:
        weights = [row[0] for row in _rows(folder / loaded.weights_name, (1,))]
    return loaded, (found, curves, weights)


def _rows(path, columns):
    """Reads rows of numbers from a comma-separated file.

    A first row without any number is a header. Lines that begin with # are skipped.
    """
    rows = []
    with open(path, encoding="utf-8-sig", newline="") as file:
        lines = (line for line in file if line.strip() and not line.lstrip().startswith("#"))
        for number, cells in enumerate(csv.reader(lines), 1):
            try:
                row = [float(cell) for cell in cells]
            except ValueError as error:
                if number == 1 and not any(map(_is_number, cells)):
                    continue
                raise Error(f"{path}: row {number}: {error}") from None
            if len(row) not in columns:
                allowed = " or ".join(map(str, columns))
                raise Error(f"{path}: row {number} has {len(row)} columns, not {allowed}")
            rows.append(row)
    return rows


def _is_number(cell):
    try:
        float(cell)
    except ValueError:
        return False
    return True
