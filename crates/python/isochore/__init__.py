"""Volume-preserving deformation of triangle meshes through divergence-free vector fields.

>>> import isochore
>>> result = isochore.run({
...     "recipe": 1,
...     "target": {"shape": {"kind": "icosphere", "radius": 1.0, "subdivisions": 3}},
...     "stroke": [{"kind": "twist", "origin": [0, 0, 0], "axis": [0, 0, 1], "degrees_per_unit": 30.0}],
... })
>>> abs(result.report["volume_change"]) < 1e-12
True

Coordinates and lengths are in model units. Arrays are C-contiguous. Arrays of a `Mesh`, a
`DistanceField` or a `Session` are read-only views of its memory. Long operations release the global
interpreter lock.
"""

from isochore._native import Cancelled, DistanceField, Error, Mesh, RecipeError, Session, Tool, remesh
from isochore._recipe import Result, run, run_points

__all__ = [
    "Cancelled",
    "DistanceField",
    "Error",
    "Mesh",
    "RecipeError",
    "Result",
    "Session",
    "Tool",
    "remesh",
    "run",
    "run_points",
]
