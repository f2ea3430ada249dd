from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Progress = Callable[[str, float], object]
"""Called on the calling thread every 50 ms with the stage at work and its share done, 0 to 1; returning False stops the work."""

class HasVerticesAndFaces(Protocol):
    """A mesh of another library, such as `trimesh.Trimesh`."""

    vertices: Any
    faces: Any

class Error(Exception):
    """Input that cannot be worked with; the message names what is at fault."""

class RecipeError(Error):
    """A recipe that cannot be followed."""

    key: str | None
    """Dotted path of what is wrong in the recipe."""
    line: int | None
    """Its line."""

class Cancelled(Error):
    """The `progress` function asked to stop."""

class Mesh:
    """A triangle mesh. It never changes: its arrays are read-only views, which keep it alive."""

    def __init__(
        self,
        positions: ArrayLike,
        triangles: ArrayLike,
        *,
        uvs: ArrayLike | None = None,
        colors: ArrayLike | None = None,
    ) -> None:
        """Copies the arrays.

        positions: (V, 3) numbers, model units. triangles: (T, 3) integers, counter-clockwise seen from outside.
        uvs: (T, 3, 2), by corner, so that seams do not open the surface. colors: (V, 4), linear RGBA, 0 to 1.
        """

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Mesh:
        """Reads a mesh file: .obj .gltf .glb .ply .stl .off. Polygons are triangulated, seams welded."""

    @classmethod
    def from_bytes(cls, data: bytes, format: str) -> Mesh:
        """Reads the bytes of a mesh file; `format` is its extension."""

    @classmethod
    def from_trimesh(cls, mesh: HasVerticesAndFaces) -> Mesh:
        """The vertices and faces of a `trimesh.Trimesh` or the like."""

    def to_trimesh(self) -> Any:
        """A `trimesh.Trimesh` with the same vertices and faces in the same order."""

    def write(self, path: str | PathLike[str]) -> None:
        """Writes a mesh file in the format of its extension, whole or not at all."""

    def to_bytes(self, format: str) -> bytes:
        """The bytes of a mesh file; `format` is its extension."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """(V, 3), model units; a view."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(T, 3) vertex indices, counter-clockwise seen from outside; a view."""

    @property
    def uvs(self) -> NDArray[np.float64] | None:
        """(T, 3, 2), the first set of texture coordinates by corner; a view."""

    @property
    def colors(self) -> NDArray[np.float64] | None:
        """(V, 4), linear RGBA by vertex; a view."""

    @property
    def volume(self) -> float:
        """Signed volume, cubic model units; means little unless `is_closed`."""

    @property
    def area(self) -> float:
        """Square model units."""

    @property
    def bounds(self) -> list[list[float]]:
        """Smallest and largest x, y, z, model units."""

    @property
    def is_closed(self) -> bool:
        """Whether every edge lies between two triangles that agree on which side is outside."""

    def self_intersections(self, *, progress: Progress | None = None) -> NDArray[np.uint32]:
        """Indices of the triangles that intersect others, by exact arithmetic, in ascending order."""

class DistanceField:
    """Signed distances to a mesh on a grid, negative inside, and the cubic spline through them."""

    def __init__(
        self,
        mesh: Mesh | HasVerticesAndFaces,
        resolution: int = 64,
        *,
        padding: float | None = None,
        band: float = ...,
        progress: Progress | None = None,
    ) -> None:
        """Samples the distance to `mesh`.

        resolution: cells on the longest side of the mesh. padding: model units around it, by default eight cells.
        band: how far from the surface distances are told apart, model units, by default everywhere.
        """

    @property
    def samples(self) -> NDArray[np.float32]:
        """Indexed [z, y, x], model units; a view."""

    @property
    def origin(self) -> list[float]:
        """Position of sample [0, 0, 0], model units."""

    @property
    def cell(self) -> float:
        """Distance between neighboring samples, model units."""

    @property
    def sample_error(self) -> float:
        """No sample is farther from the exact distance than this, model units."""

    def __call__(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Distances (N,) at points (N, 3), and the gradients (N, 3) of the very spline that gives them.

        At the border of the grid the spline bends: eight cells inside, the gradient is off by 3e-5 at most because of it.
        Beyond the grid the distance is infinite and the gradient zero.
        """

class Result(NamedTuple):
    """What became of a recipe's target."""

    mesh: Mesh
    """The mesh, refined and deformed."""
    rest: Mesh
    """The same triangles before the strokes."""
    report: dict[str, Any]
    """The report; its schema is that of the command's (`isochore schema report`)."""

def run(
    recipe: str | PathLike[str] | Mapping[str, Any],
    *,
    meshes: Mapping[str, Mesh | HasVerticesAndFaces] | None = None,
    settings: Mapping[str, Any] | Iterable[str] = (),
    progress: Progress | None = None,
) -> Result:
    """Deforms the target of a recipe, as `isochore run` does, and writes no file.

    recipe: path of a TOML or JSON file, or its keys. meshes: meshes by the names that the recipe gives them, in place of files;
    what is not among them is read, relative to the recipe. settings: win over the recipe, {"refine.volume": 1e-5}.

    Raises RecipeError where the recipe cannot be followed, Error where a mesh cannot be worked with, OSError where a file cannot be
    read, Cancelled where `progress` returned False.
    """

def run_points(
    recipe: str | PathLike[str] | Mapping[str, Any],
    points: ArrayLike,
    *,
    meshes: Mapping[str, Mesh | HasVerticesAndFaces] | None = None,
    settings: Mapping[str, Any] | Iterable[str] = (),
    progress: Progress | None = None,
) -> tuple[NDArray[np.float64], list[str]]:
    """Carries points (N, 3), model units, along the strokes of a recipe: where they come to, (N, 3), and warnings.

    Points have no surface and no volume: there is no refinement and no lock, and stamps are refused.
    """
