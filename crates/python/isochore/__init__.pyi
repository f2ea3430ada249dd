from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, NamedTuple, Protocol, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Cancelled",
    "DistanceField",
    "Error",
    "Mesh",
    "RecipeError",
    "Result",
    "Session",
    "Tool",
    "run",
    "run_points",
]

_Progress = Callable[[str, float], object]
"""Called on the calling thread every 50 ms with the stage at work and its share done, 0 to 1; returning False stops the work."""

class _HasVerticesAndFaces(Protocol):
    """A mesh of another library, such as `trimesh.Trimesh`, of which `visual` is taken too, as `Mesh.from_trimesh` tells."""

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

@final
class Mesh:
    """A triangle mesh. It never changes: its arrays are read-only views, which keep it alive.

    It can be pickled, with all that a file said of it, and so be sent to other processes.
    """

    def __new__(
        cls,
        positions: ArrayLike,
        triangles: ArrayLike,
        *,
        uvs: Iterable[ArrayLike] | None = None,
        normals: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        corner_colors: ArrayLike | None = None,
        skin: tuple[ArrayLike, ArrayLike] | None = None,
        materials: Sequence[str] | None = None,
        triangle_materials: ArrayLike | None = None,
    ) -> Self:
        """Copies the arrays.

        positions: (V, 3) numbers, model units. triangles: (T, 3) integers, counter-clockwise seen from outside.
        uvs: sets of texture coordinates, (T, 3, 2) each, by corner, so that seams do not open the surface, kept in single precision.
        normals: for shading, by corner, (T, 3, 3), of any length; they turn with the surface and are kept in single precision too.
        colors: by vertex, (V, 4), linear RGBA, 0 to 1. corner_colors: by corner, (T, 3, 4), where they differ across seams.
        skin: joints (V, K), integers, and their weights (V, K), which are divided by the sum of each row; weight 0 is for places not used.
        materials: names; an empty one stands for triangles without a material. triangle_materials: (T,) indices into them; each needs
        the other.
        """

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Mesh:
        """Reads a mesh file: .obj .gltf .glb .ply .stl .off. Polygons are triangulated, seams welded."""

    @classmethod
    def from_bytes(cls, data: bytes, format: str) -> Mesh:
        """Reads the bytes of a mesh file; `format` is its extension."""

    @classmethod
    def from_trimesh(cls, mesh: _HasVerticesAndFaces) -> Mesh:
        """The mesh of a `trimesh.Trimesh`, or of anything with `vertices` (V, 3) and `faces` (T, 3).

        Where its `visual` has a texture or colors, texture coordinates, colors and names of materials come along, and vertices that
        trimesh has twice at a seam are welded, so that the surface is closed; the numbers of vertices after them change then. Images
        and normals stay behind: trimesh derives normals from faces.
        """

    def to_trimesh(self) -> Any:
        """A `trimesh.Trimesh` of the same triangles in the same order.

        The first set of texture coordinates, colors, in 8 bits, and names of materials come along. Vertices are the same in the same
        order, followed by copies of those at seams, which trimesh needs: `from_trimesh` welds them. Give the visual its images anew:
        `result.visual.material = scan.visual.material`.
        """

    def welded(self) -> Mesh:
        """The same surface with the vertices of open edges made one where they are at the same position.

        Closed surfaces that touch stay apart. Colors that differ move to the corners; of differing skins the first one stays.
        """

    def split_at_seams(self) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """What libraries and renderers need that keep all attributes by vertex: one for each combination of UVs, normals and colors.

        The vertex of this mesh that each of these is, (R,), and triangles (T, 3) of them. The first V are the vertices of the mesh.
        An attribute by corner goes to them by `values[triangles] = mesh.uvs[0]`.
        """

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
    def uvs(self) -> list[NDArray[np.float32]]:
        """Sets of texture coordinates by corner, (T, 3, 2) each, in single precision; views."""

    @property
    def normals(self) -> NDArray[np.float32] | None:
        """Shading normals by corner, (T, 3, 3), unit length, in single precision; a view."""

    @property
    def colors(self) -> NDArray[np.float64] | None:
        """(V, 4), linear RGBA by vertex; a view."""

    @property
    def corner_colors(self) -> NDArray[np.float64] | None:
        """(T, 3, 4), linear RGBA by corner, where colors differ across seams; a view."""

    @property
    def materials(self) -> list[str]:
        """Names; an empty one stands for triangles without a material."""

    @property
    def triangle_materials(self) -> NDArray[np.uint32] | None:
        """(T,) indices into `materials`; a view."""

    @property
    def skin(self) -> tuple[NDArray[np.uint32], NDArray[np.float64]] | None:
        """Joints (V, K) and their weights (V, K), where K is the most that a vertex has; rows sum to 1, or to 0 without joints. A copy."""

    @property
    def volume(self) -> float:
        """Signed volume, cubic model units; means little unless `is_closed`."""

    @property
    def area(self) -> float:
        """Square model units."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3), smallest and largest x, y, z, model units."""

    @property
    def is_closed(self) -> bool:
        """Whether every edge lies between two triangles that agree on which side is outside."""

    def __copy__(self) -> Mesh: ...
    def __deepcopy__(self, memo: Any, /) -> Mesh: ...
    def self_intersections(self, *, progress: _Progress | None = None) -> NDArray[np.uint32]:
        """Indices of the triangles that intersect others, by exact arithmetic, in ascending order."""

@final
class DistanceField:
    """Signed distances to a mesh on a grid, negative inside, and the cubic spline through them."""

    def __new__(
        cls,
        mesh: Mesh | _HasVerticesAndFaces,
        resolution: int = 64,
        *,
        padding: float | None = None,
        band: float = ...,
        progress: _Progress | None = None,
    ) -> Self:
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

@final
class Tool:
    """A tool ready to work, made once and shared between strokes and sessions."""

    def __new__(
        cls,
        description: Mapping[str, Any],
        *,
        name: str = "tool",
        mesh: Mesh | _HasVerticesAndFaces | None = None,
        progress: _Progress | None = None,
    ) -> Self:
        """Makes a tool from what a recipe says of one: {"shape": {"kind": "sphere", "radius": 0.1}, "support": 0.1}.

        name: what the log calls it. mesh: the mesh of a shape of the kind "mesh", whose distance is sampled now.
        """

    @property
    def name(self) -> str: ...
    @property
    def warnings(self) -> list[str]:
        """What there is to know about how the description was understood."""

@final
class Session:
    """A mesh that strokes deform one after the other, at the pace of a frame, with undo and redo.

    First come the vertices of the mesh as opened, which keep their numbers, then inserted ones. Where one of these was removed, a later
    stroke may give its number to another. The buffers hold render vertices: a
    vertex as the triangles on one side of a seam see it. Render vertex i is vertex i of the mesh as opened as long as there are that
    many.

    `positions`, `normals`, `uvs`, `colors` and `triangles` are views of the session's own buffers. While one is held the session does
    not change: strokes, undo and redo raise BufferError until it is dropped.
    """

    def __new__(
        cls,
        mesh: Mesh | _HasVerticesAndFaces,
        *,
        step: float | None = None,
        undo_bytes: int | None = None,
        normals: Literal["area", "angle"] = "area",
        mask: ArrayLike | Mapping[str, Any] | None = None,
        lock: bool = True,
    ) -> Self:
        """Opens a session on a manifold, oriented mesh.

        step: travel of the fastest point of the tool's surface in one time step, as a share of the support or of half the tool's
        shortest extent, whichever is less; at most 1.
        undo_bytes: what undo and redo may hold; beyond, the oldest strokes are forgotten. normals: how triangles are weighted in vertex
        normals, by "area" or "angle".
        mask: a weight for each vertex, (V,), from 0, free, to 1, held; or what a recipe says under `mask`, {"pins": [...], "mirror": [...],
        "vertices": weights, "fade": length}. Vertices that are held keep their bits.
        lock: whether each stroke ends with the volume of the mesh as opened, by a small displacement of what it has moved.
        """

    def begin_stroke(
        self,
        tool: Tool,
        *,
        refine: bool = True,
        longest_edge: float | None = None,
        max_triangles: int | None = None,
        keep: Sequence[tuple[ArrayLike, float]] = ...,
    ) -> None:
        """Begins a stroke; nothing moves before the second pose.

        refine: whether edges in the tool's reach are split, collapsed and flipped. longest_edge: longer ones are split, model units.
        keep: balls, by center (3,) and radius, in which the triangles stay as they are.
        """

    def freeze_edges(self, vertices: ArrayLike) -> None:
        """Keeps the edges at these vertices (N,), inserted ones included, from being split, collapsed or flipped, and frees all others."""

    def move_to(
        self, at: ArrayLike, *, rotate: ArrayLike = ..., time: float = 0.0
    ) -> dict[str, Any]:
        """Moves the tool along a screw to a pose: `at` (3,), model units; `rotate` axis x, y, z and degrees, absolute.

        time: seconds of the host's clock, for the log of the receipt alone. Returns what was moved, inserted, removed and flipped.
        """

    def end_stroke(self) -> dict[str, Any]:
        """Ends the stroke; its receipt, with signed changes of volume by the flow, by splits and by remeshing apart.

        lock_max_shift: the longest displacement by the lock, model units; None where it was skipped. lock_skipped: why it was: "off",
        the session has none; "needs_closed", the surface is open; "no_hold", nothing moved that the volume depends on, and the lock of
        the next stroke has to make up for what is missing. None where it acted.
        """

    def cancel_stroke(self) -> None:
        """Takes back the stroke under way."""

    def undo(self) -> bool:
        """Takes back the last stroke, to the bit; False where there is none."""

    def redo(self) -> bool:
        """Does again what was undone last, to the bit; False where there is nothing."""

    def log(self) -> dict[str, Any]:
        """All strokes that are done, as a recipe for `run` and `run_points`, on this mesh (its name is "target") or any other."""

    def export(self, *, lock: bool = True) -> tuple[Mesh, NDArray[np.uint32]]:
        """The surface as a mesh, as `positions` show it, and the number (V,) in the session of each of its vertices.

        lock: with what the lock has added at the end of each stroke, which keeps the volume; without it vertices are where the flow
        alone has taken them, to the bits that the log gives elsewhere.
        """

    @property
    def positions(self) -> NDArray[np.float32]:
        """(R, 3), model units; a view."""

    @property
    def normals(self) -> NDArray[np.float32]:
        """(R, 3), unit length; a view."""

    @property
    def uvs(self) -> list[NDArray[np.float32]]:
        """Sets of texture coordinates, (R, 2) each; views."""

    @property
    def colors(self) -> NDArray[np.float32]:
        """(R, 4), linear RGBA, or (0, 4) where the mesh has none; a view."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(T, 3) render vertices; those removed are three times zero; a view."""

    def take_changes(self) -> dict[str, Any]:
        """What has changed in the buffers since the last call, at first everything: pairs (start, end) of rows by buffer.

        `attributes` stands for UVs, colors and origins. Give copies the buffers' lengths first, then copy the rows.
        """

    def pick(self, origin: ArrayLike, direction: ArrayLike) -> dict[str, Any] | None:
        """The first point of the surface on a ray: `point`, `normal`, `distance`, `triangle`, `vertices`.

        `weights` are its barycentric coordinates: how much each of the three vertices counts for it.
        """

    def closest_point(self, point: ArrayLike) -> dict[str, Any] | None:
        """The nearest point of the surface, as `pick` tells of it."""

    def vertices_in_reach(self, tool: Tool, at: ArrayLike, *, rotate: ArrayLike = ...) -> NDArray[np.uint32]:
        """Numbers (N,) of the vertices that a stroke of the tool would move at this pose, in ascending order.

        They count as reached where the flow has left them, without what the lock has added, and masks are not looked at.
        """

    def preview(
        self,
        tool: Tool,
        start: ArrayLike,
        end: ArrayLike,
        *,
        start_rotate: ArrayLike = ...,
        end_rotate: ArrayLike = ...,
        per_side: int = 12,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Points (N, 3) around the tool, and where a move from `start` to `end` would shift them, (N, 3): arrows to draw."""

    @property
    def moved_volume(self) -> tuple[float, float]:
        """Volume that the stroke under way has moved outward and inward so far, cubic model units."""

    @property
    def is_stroke_under_way(self) -> bool:
        """Whether a stroke has begun and not ended."""

    @property
    def volume(self) -> float | None:
        """Volume inside the surface; None where it is open."""

    @property
    def history(self) -> dict[str, int]:
        """Strokes `undoable`, `redoable` and `forgotten`, and `bytes` held for them."""

    def origins(self) -> tuple[NDArray[np.uint32], NDArray[np.float64]]:
        """Where on the mesh as opened render vertices take their attributes from: triangles (R,) and barycentric coordinates (R, 3).

        A vertex without triangles has the triangle 2**32 - 1 and coordinates of zero.
        """

    def vertex_map(self) -> NDArray[np.uint32]:
        """For each vertex of the mesh as opened, (V,), the vertex that stands in its place: itself, or what collapses merged it into."""

    def vertices_of_render_vertices(self) -> NDArray[np.uint32]:
        """Number (R,) of the vertex of each render vertex; 2**32 - 1 where it was removed."""

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
    meshes: Mapping[str, Mesh | _HasVerticesAndFaces] | None = None,
    settings: Mapping[str, Any] | Iterable[str] = (),
    progress: _Progress | None = None,
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
    meshes: Mapping[str, Mesh | _HasVerticesAndFaces] | None = None,
    settings: Mapping[str, Any] | Iterable[str] = (),
    progress: _Progress | None = None,
) -> tuple[NDArray[np.float64], list[str]]:
    """Carries points (N, 3), model units, along the strokes of a recipe: where they come to, (N, 3), and warnings.

    Points have no surface and no volume: there is no refinement and no lock, and stamps are refused.
    """
