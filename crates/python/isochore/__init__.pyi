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
"""Progress callback: `progress(stage, fraction)`.

`stage` names the current stage, and `fraction` is the completed part of it, 0 to 1. The calling
thread runs it every 50 ms. Returning False cancels the operation, which then raises `Cancelled`. An
exception raised in the callback cancels it too.
"""

class _HasVerticesAndFaces(Protocol):
    """A mesh of another library, such as `trimesh.Trimesh`; see `Mesh.from_trimesh`."""

    vertices: Any
    faces: Any

class Error(Exception):
    """Invalid input. The message names the offending element and the problem."""

class RecipeError(Error):
    """Invalid recipe, tool description or mask."""

    key: str | None
    """Dotted path of the offending key, such as "tools.ball.support", or None if unknown."""
    line: int | None
    """Line of the recipe file, from 1, or None if unknown."""

class Cancelled(Error):
    """The `progress` callback returned False."""

@final
class Mesh:
    """An immutable triangle mesh with V vertices and T triangles.

    Its arrays are read-only views of its memory and keep it alive. A mesh can be pickled with all
    its attributes and the metadata of its file.

    >>> import isochore
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> mesh = isochore.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> mesh.is_closed, round(mesh.volume, 4)
    (True, 0.1667)
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

        positions: (V, 3) numbers, model units.
        triangles: (T, 3) integers, counter-clockwise as seen from outside.
        uvs: sets of texture coordinates per corner, (T, 3, 2) each, stored as float32. Seams do not
            open the surface.
        normals: shading normals per corner, (T, 3, 3), of any nonzero length, stored as float32.
            They rotate with the surface.
        colors: (V, 4), linear RGBA per vertex, 0 to 1.
        corner_colors: (T, 3, 4), linear RGBA per corner, 0 to 1. They may differ across seams.
        skin: joints (V, K), integers, and weights (V, K). Each row of weights is normalized. Weight
            0 marks an unused entry.
        materials: names of materials. An empty name means no material. Requires
            `triangle_materials`.
        triangle_materials: (T,) indices into `materials`.

        Raises ValueError if an array has the wrong shape, type or range, and Error if an index is
        out of range or a position is not finite.
        """

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Mesh:
        """Reads a mesh file: .obj, .gltf, .glb, .ply, .stl or .off.

        Polygons are triangulated and seams are welded.

        Raises OSError if the file cannot be read and Error if its content is invalid.
        """

    @classmethod
    def from_bytes(cls, data: bytes, format: str) -> Mesh:
        """Reads the content of a mesh file. `format` is its extension, such as "ply".

        Raises ValueError if the format is unknown and Error if the content is invalid.
        """

    @classmethod
    def from_trimesh(cls, mesh: _HasVerticesAndFaces) -> Mesh:
        """Converts a `trimesh.Trimesh`, or any object with `vertices` (V, 3) and `faces` (T, 3).

        If its `visual` has a texture or colors, the result has the texture coordinates, the colors
        and the names of the materials. trimesh duplicates vertices at seams; they are welded, which
        closes the surface and changes vertex indices. Images and normals are not converted: trimesh
        derives normals from faces.

        Raises TypeError if `mesh` has no `vertices` and `faces`.
        """

    def to_trimesh(self) -> Any:
        """Converts to a `trimesh.Trimesh` with the same triangles in the same order.

        The result has the first set of texture coordinates, the colors in 8 bits, and the names of
        the materials. The vertices keep their order and are followed by the duplicates at seams
        that trimesh needs; `from_trimesh` welds them again. Images are not converted. Assign them
        afterwards: `result.visual.material = scan.visual.material`.
        """

    def welded(self) -> Mesh:
        """Returns the same surface with the coincident vertices of open edges merged.

        Closed surfaces that touch each other remain separate. Colors that differ are moved to the
        corners. Of skins that differ, the first is kept.
        """

    def split_at_seams(self) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """Splits vertices for renderers and libraries that store all attributes per vertex.

        Returns `vertices` (R,), the vertex of this mesh for each split vertex, and `triangles`
        (T, 3), indices of split vertices. There is one split vertex for each combination of UVs,
        normals and colors at a vertex. The first V are the vertices of this mesh. To convert a
        corner attribute, write `values[triangles] = mesh.uvs[0]`.
        """

    def write(self, path: str | PathLike[str]) -> None:
        """Writes a mesh file in the format that the extension selects.

        An existing file is replaced only when the new one is complete.

        Raises OSError if the file cannot be written and Error if the format cannot represent the
        mesh.
        """

    def to_bytes(self, format: str) -> bytes:
        """Returns the content of a mesh file. `format` is its extension, such as "ply".

        Raises ValueError if the format is unknown and Error if it cannot represent the mesh.
        """

    @property
    def positions(self) -> NDArray[np.float64]:
        """(V, 3), model units; a view."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(T, 3) vertex indices, counter-clockwise as seen from outside; a view."""

    @property
    def uvs(self) -> list[NDArray[np.float32]]:
        """Sets of texture coordinates per corner, (T, 3, 2) each; views."""

    @property
    def normals(self) -> NDArray[np.float32] | None:
        """(T, 3, 3), unit shading normals per corner, or None if the mesh has none; a view."""

    @property
    def colors(self) -> NDArray[np.float64] | None:
        """(V, 4), linear RGBA per vertex, or None if the mesh has no vertex colors; a view."""

    @property
    def corner_colors(self) -> NDArray[np.float64] | None:
        """(T, 3, 4), linear RGBA per corner, or None if the mesh has no corner colors; a view."""

    @property
    def materials(self) -> list[str]:
        """Names of the materials. An empty name means no material."""

    @property
    def triangle_materials(self) -> NDArray[np.uint32] | None:
        """(T,) indices into `materials`, or None if the mesh has no materials; a view."""

    @property
    def skin(self) -> tuple[NDArray[np.uint32], NDArray[np.float64]] | None:
        """Joints (V, K) and weights (V, K), or None if the mesh has no skin; copies.

        K is the largest number of joints of any vertex. Each row of weights sums to 1, or to 0 for
        a vertex without joints.
        """

    @property
    def volume(self) -> float:
        """Signed volume, cubic model units. Meaningful only if `is_closed`."""

    @property
    def area(self) -> float:
        """Surface area, square model units."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Axis-aligned bounding box, (2, 3): minimum and maximum of x, y, z, model units."""

    @property
    def is_closed(self) -> bool:
        """Whether every edge has exactly two triangles with consistent orientation."""

    def __copy__(self) -> Mesh: ...
    def __deepcopy__(self, memo: Any, /) -> Mesh: ...
    def self_intersections(self, *, progress: _Progress | None = None) -> NDArray[np.uint32]:
        """Returns the indices of the triangles that intersect other triangles, in ascending order.

        The test uses exact arithmetic.
        """

@final
class DistanceField:
    """Signed distances to a mesh on a grid, negative inside, with cubic interpolation.

    >>> import isochore
    >>> shape = {"kind": "icosphere", "radius": 1.0, "subdivisions": 3}
    >>> ball = isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh
    >>> field = isochore.DistanceField(ball, resolution=32)
    >>> distances, gradients = field([[0, 0, 0.5], [0, 0, 1.4]])
    >>> [round(distance, 1) for distance in distances.tolist()], gradients.shape
    ([-0.5, 0.4], (2, 3))
    """

    def __new__(
        cls,
        mesh: Mesh | _HasVerticesAndFaces,
        resolution: int = 64,
        *,
        padding: float | None = None,
        band: float = ...,
        progress: _Progress | None = None,
    ) -> Self:
        """Samples the signed distance to `mesh`.

        resolution: number of cells along the longest side of the mesh, without the padding; at
            least 4.
        padding: margin around the mesh, model units; eight cells by default.
        band: largest distance that is computed, model units. Samples farther from the surface have
            this distance. Unlimited by default.

        Raises Error if the mesh or an option cannot be used.
        """

    @property
    def samples(self) -> NDArray[np.float32]:
        """Samples indexed [z, y, x], model units; a view."""

    @property
    def origin(self) -> list[float]:
        """Position of sample [0, 0, 0], model units."""

    @property
    def cell(self) -> float:
        """Distance between neighboring samples, model units."""

    @property
    def sample_error(self) -> float:
        """Bound on the error of a sample, model units."""

    def __call__(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns the distances (N,) and their gradients (N, 3) at points (N, 3).

        The gradients are those of the spline that gives the distances. Beyond the grid, distances
        are infinite and gradients are zero. The border of the grid disturbs the spline: eight cells
        inside the grid, the resulting error of the gradient is at most 3e-5.
        """

@final
class Tool:
    """A prepared tool. It can be used by any number of strokes and sessions.

    >>> import isochore
    >>> shape = {"kind": "sphere", "radius": 0.1}
    >>> brush = isochore.Tool({"shape": shape, "support": 0.2}, name="brush")
    >>> brush.name, brush.warnings
    ('brush', [])
    """

    def __new__(
        cls,
        description: Mapping[str, Any],
        *,
        name: str = "tool",
        mesh: Mesh | _HasVerticesAndFaces | None = None,
        progress: _Progress | None = None,
    ) -> Self:
        """Creates a tool from its description in a recipe.

        description: such as {"shape": {"kind": "sphere", "radius": 0.1}, "support": 0.1}.
        name: name of the tool in the log of a session.
        mesh: mesh of a shape of kind "mesh". Its distance is sampled during this call.

        Raises RecipeError if the description is invalid.
        """

    @property
    def name(self) -> str:
        """Name of the tool in the log of a session."""

    @property
    def warnings(self) -> list[str]:
        """Warnings about the description."""

@final
class Session:
    """A mesh that strokes deform one after another at interactive rates, with undo and redo.

    Vertices of the opened mesh keep their numbers. Inserted vertices follow. A later stroke may
    reuse the number of a vertex that an earlier stroke has removed.

    The buffers `positions`, `normals`, `uvs`, `colors` and `triangles` are for rendering. They hold
    R render vertices: a render vertex is a vertex as seen by the triangles on one side of a seam.
    Render vertex i is vertex i of the opened mesh for each of its vertices.

    The buffers are views of the memory of the session. While a view exists, the session cannot
    change: strokes, undo and redo raise BufferError.

    >>> import isochore
    >>> shape = {"kind": "icosphere", "radius": 1.0, "subdivisions": 4}
    >>> ball = isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh
    >>> session = isochore.Session(ball)
    >>> ball_shape = {"kind": "sphere", "radius": 0.2}
    >>> session.begin_stroke(isochore.Tool({"shape": ball_shape, "support": 0.3}))
    >>> moves = [session.move_to([0, 0, 1.2 - 0.05 * step]) for step in range(4)]
    >>> receipt = session.end_stroke()
    >>> receipt["moves"], receipt["touched_vertices"] > 0
    (3, True)
    >>> mesh, vertices = session.export()
    >>> abs(mesh.volume / ball.volume - 1) < 1e-12
    True
    >>> session.undo()
    True
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
        """Opens a session on a manifold, consistently oriented mesh.

        step: time step, given as the distance that the fastest point of the tool surface travels in
            one step. It is a fraction, at most 1, of the support or of half the shortest extent of
            the tool, whichever is smaller.
        undo_bytes: memory budget of undo and redo. Beyond it, the oldest strokes are removed from
            the history.
        normals: weighting of triangles in vertex normals, by "area" or "angle".
        mask: weights (V,) from 0 (free) to 1 (masked), or the `mask` table of a recipe: {"pins":
            [...], "mirror": [...], "vertices": weights, "fade": length}. Vertices of weight 1 keep
            their exact positions.
        lock: whether each stroke ends with the volume lock, a small displacement of the moved
            vertices that restores the volume of the opened mesh.

        Raises Error if the mesh or an option cannot be used, RecipeError if the mask table is
        invalid, and ValueError if an argument has the wrong shape.
        """

    def begin_stroke(
        self,
        tool: Tool,
        *,
        refine: bool = True,
        longest_edge: float | None = None,
        deviation: float | None = None,
        max_triangles: int | None = None,
        keep: Sequence[tuple[ArrayLike, float]] = ...,
    ) -> None:
        """Begins a stroke. The first pose only places the tool; later ones move it.

        refine: whether edges in reach of the tool are split, and crossings of the surface with
            itself are prevented.
        longest_edge: edges longer than this are split, model units.
        deviation: edges are split where the curved surface deviates from them by more than this,
            model units.
        max_triangles: splits stop at this number of triangles.
        keep: balls, given by center (3,) and radius, in which triangles are not refined.

        Raises Error if a stroke is in progress.
        """

    def freeze_edges(self, vertices: ArrayLike) -> None:
        """Excludes the edges at the given vertices (N,) from splits, collapses and flips.

        The vertices replace those of the previous call and may include inserted ones. Raises
        ValueError if one is out of range.
        """

    def move_to(
        self, at: ArrayLike, *, rotate: ArrayLike = ..., time: float = 0.0
    ) -> dict[str, Any]:
        """Moves the tool to a pose along a screw motion.

        at: position (3,), model units.
        rotate: axis x, y, z and angle in degrees, (4,), relative to the unrotated tool.
        time: time of the host in seconds, not less than that of the previous move. It affects only
            the receipt.

        Returns `moved_vertices`, `inserted_vertices`,
        `is_limited` (whether `max_triangles` prevented splits), `refused_splits` (edges that remain
        too long or too coarse because the stroke has distorted the surface too much for a split to
        help), `is_stopped` (whether the stroke has been ended because the surface would cross
        itself farther on; later moves of the stroke have no effect) and `seconds`.

        Raises Error if no stroke is in progress, and ValueError if a number is not finite or the
        axis is zero.
        """

    def end_stroke(self) -> dict[str, Any]:
        """Ends the stroke, applies the volume lock, and returns the receipt of the stroke.

        The receipt has the counts of all moves and these keys:

        removed_vertices, flipped_edges: number of vertices that collapses removed, and of edges that
            were flipped.
        volume: signed volume changes by "flow", "splits" and "remeshing", and a bound on their
            "rounding" error, cubic model units; None if the surface is open.
        lock_max_shift: largest displacement by the volume lock, model units, or None if the lock
            was skipped.
        lock_skipped: None if the lock was applied. Otherwise "off" (disabled), "needs_closed" (the
            surface is open), "no_hold" (the moved vertices cannot change the volume) or "crossings"
            (sheets of the surface are so close that the lock would make them cross). In the last
            two cases the lock of the next stroke corrects the remaining error.
        stopped_at: fraction of the stroke, from 0 to 1, at which it was ended because the surface
            would have crossed itself, or None. The log contains the shortened stroke. A stroke that
            was ended at 0 leaves no trace.
        sheets: the two sheets that would have crossed, when the stroke was ended: their distance
            "gap" and the point "at" midway between them, model units; or None.
        crossings: number of pairs of triangles that the stroke made cross. 0 unless this stroke, or
            an earlier one, had refine=False.
        certificate_seconds: wall time of finding and removing crossings.

        Raises Error if no stroke is in progress.
        """

    def cancel_stroke(self) -> None:
        """Discards the stroke in progress. Raises Error if no stroke is in progress."""

    def undo(self) -> bool:
        """Undoes the last stroke, bit for bit. Returns False if there is none."""

    def redo(self) -> bool:
        """Redoes the last undone stroke, bit for bit. Returns False if there is none."""

    def log(self) -> dict[str, Any]:
        """Returns the strokes that are in effect as a recipe, which names its target "target"."""

    def export(self, *, lock: bool = True) -> tuple[Mesh, NDArray[np.uint32]]:
        """Copies the surface to a mesh.

        Returns the mesh and the session vertex of each of its vertices.

        lock: whether positions include the displacements of the volume lock, as the buffers do.
            Otherwise they are those of the flow alone, which a replay of the log reproduces bit for
            bit.
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
        """(R, 4), linear RGBA, or (0, 4) if the mesh has no colors; a view."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(T, 3) render vertices, three zeros for a removed triangle; a view."""

    def take_changes(self) -> dict[str, Any]:
        """Returns the buffer ranges that have changed since the previous call.

        The first call returns everything.

        The keys "positions", "normals", "attributes" and "triangles" have lists of half-open ranges
        (start, end) of rows. "attributes" covers UVs, colors and origins. "generation" increases
        whenever a buffer has moved in memory. To update copies, resize them to the lengths of the
        buffers first, then copy the rows.
        """

    def pick(self, origin: ArrayLike, direction: ArrayLike) -> dict[str, Any] | None:
        """Finds the first point of the surface along a ray.

        Returns None if the ray misses the surface.

        The result has `point`, `normal`, `triangle`, `vertices`, `weights` (the barycentric
        coordinates of the point) and `distance`, in multiples of the length of `direction`.
        """

    def closest_point(self, point: ArrayLike) -> dict[str, Any] | None:
        """Finds the closest point of the surface, or None if the mesh has no triangles.

        The result has the keys of `pick`, with `distance` in model units.
        """

    def vertices_in_reach(self, tool: Tool, at: ArrayLike, *, rotate: ArrayLike = ...) -> NDArray[np.uint32]:
        """Returns the vertices (N,) that the tool would move at this pose, in ascending order.

        The test ignores masks and uses positions without the displacements of the volume lock.
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
        """Returns points (N, 3) and their displacements (N, 3) by a move, for display as arrows.

        per_side: number of points along the longest side of the support, at most 64.
        """

    @property
    def moved_volume(self) -> tuple[float, float]:
        """Volumes that the stroke in progress has moved outward and inward, cubic model units."""

    @property
    def is_stroke_under_way(self) -> bool:
        """Whether a stroke is in progress."""

    @property
    def volume(self) -> float | None:
        """Enclosed volume before any lock, cubic model units, or None if the surface is open."""

    @property
    def history(self) -> dict[str, int]:
        """Numbers of `undoable`, `redoable` and `forgotten` strokes, and their `bytes`."""

    def origins(self) -> tuple[NDArray[np.uint32], NDArray[np.float64]]:
        """Returns the points of the opened mesh that provide the attributes of the render vertices.

        These are triangles (R,) of the opened mesh and barycentric coordinates (R, 3). A vertex
        without triangles has the triangle 2**32 - 1 and zeros.
        """

    def vertex_map(self) -> NDArray[np.uint32]:
        """Returns the vertices (V,) that represent those of the opened mesh.

        Each is the vertex itself, or the vertex that collapses have merged it into.
        """

    def vertices_of_render_vertices(self) -> NDArray[np.uint32]:
        """Returns the vertex of each render vertex, (R,), or 2**32 - 1 if it has been removed."""

class Result(NamedTuple):
    """Result of a recipe."""

    mesh: Mesh
    """The deformed mesh, refined where necessary."""
    rest: Mesh
    """The same triangles before deformation."""
    report: dict[str, Any]
    """The report. Its schema is that of the command: `isochore schema report`."""

def run(
    recipe: str | PathLike[str] | Mapping[str, Any],
    *,
    meshes: Mapping[str, Mesh | _HasVerticesAndFaces] | None = None,
    settings: Mapping[str, Any] | Iterable[str] = (),
    progress: _Progress | None = None,
) -> Result:
    """Deforms the target of a recipe like the command `isochore run`, but writes no files.

    recipe: path of a TOML or JSON file, or a mapping with the keys of a recipe.
    meshes: meshes by the names that the recipe uses. All other meshes are read from files relative
        to the recipe.
    settings: override keys of the recipe: {"refine.volume": 1e-5} or ["refine.volume=1e-5"].

    Raises RecipeError if the recipe is invalid, Error if a mesh cannot be used, OSError if a file
    cannot be read, and Cancelled if `progress` returned False.

    >>> import isochore
    >>> twist = {"kind": "twist", "origin": [0, 0, 0], "axis": [0, 0, 1], "degrees_per_unit": 30.0}
    >>> shape = {"kind": "box", "half_extents": [0.5, 0.5, 1], "segments": [4, 4, 8]}
    >>> result = isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": [twist]})
    >>> abs(result.mesh.volume - 2) < 1e-12
    True
    """

def run_points(
    recipe: str | PathLike[str] | Mapping[str, Any],
    points: ArrayLike,
    *,
    meshes: Mapping[str, Mesh | _HasVerticesAndFaces] | None = None,
    settings: Mapping[str, Any] | Iterable[str] = (),
    progress: _Progress | None = None,
) -> tuple[NDArray[np.float64], list[str]]:
    """Advects points (N, 3), model units, along the strokes of a recipe.

    Returns the advected points (N, 3) and warnings.

    The arguments are those of `run`. Points have neither a surface nor a volume, so refinement and
    the volume lock do not apply, and a recipe with a stamp raises RecipeError.

    >>> import isochore
    >>> twist = {"kind": "twist", "origin": [0, 0, 0], "axis": [0, 0, 1], "degrees_per_unit": 90.0}
    >>> shape = {"kind": "box", "half_extents": [0.5, 0.5, 1], "segments": [4, 4, 8]}
    >>> recipe = {"recipe": 1, "target": {"shape": shape}, "stroke": [twist]}
    >>> points, warnings = isochore.run_points(recipe, [[1, 0, 1]])
    >>> points.round(6).tolist()
    [[0.0, 1.0, 1.0]]
    """
