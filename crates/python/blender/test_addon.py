"""The add-on on a cube with all kinds of attributes of a Blender mesh."""

import bpy  # before bmesh and mathutils, which come with it
import bmesh
import isochore_blender
import numpy as np
import pytest
from isochore_blender.surface import read
from mathutils import Vector

BALL = """
recipe = 1
[target]
mesh = "unused.obj"
[tools.ball]
shape = { kind = "sphere", radius = 0.5 }
support = 0.4
[[stroke]]
kind = "move"
tool = "ball"
keys = [{ at = [3, 0, 2.0] }, { at = [3, 0, 1.3] }]
[refine]
max_edge = 0.25
[promise]
volume = 1e-6
"""
"""Presses a ball into the top of a cube at x = 3. The add-on never reads the file of the target."""


@pytest.fixture(scope="module", autouse=True)
def addon():
    isochore_blender.register()
    yield
    isochore_blender.unregister()


@pytest.fixture
def cube():
    """A cube of edge 1 with 4 x 4 quads per side, scaled by 2 and placed at x = 3."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cube_add(size=1)
    cube = bpy.context.object
    cube.location, cube.scale = (3, 0, 0), (2, 2, 2)
    mesh = cube.data
    shape = bmesh.new()
    shape.from_mesh(mesh)
    bmesh.ops.subdivide_edges(shape, edges=shape.edges, cuts=3, use_grid_fill=True)
    shape.to_mesh(mesh)
    positions = read(mesh.vertices, "co", 3, np.float32)
    corners = positions[read(mesh.loops, "vertex_index", 1, np.int32)]
    second = mesh.uv_layers.new(name="second")
    second.data.foreach_set("uv", (corners[:, :2] * [1, 0.5]).astype(np.float32).ravel())
    second.active_render = True
    mesh.color_attributes.new("painted", "FLOAT_COLOR", "POINT").data.foreach_set("color", rgba(positions).ravel())
    mesh.color_attributes.new("corners", "FLOAT_COLOR", "CORNER").data.foreach_set("color", rgba(corners).ravel())
    for name, axis in [("right", 0), ("top", 2)]:
        group = cube.vertex_groups.new(name=name)
        for index in np.flatnonzero(positions[:, axis] > 0).tolist():
            group.add([index], float(positions[index, axis]) + 0.5, "REPLACE")
    for name in ["sides", "top"]:
        mesh.materials.append(bpy.data.materials.new(name))
    for polygon in mesh.polygons:
        polygon.material_index = int(polygon.normal.z > 0.5)
    sharp = mesh.attributes.new("sharp_edge", "BOOLEAN", "EDGE")
    sharp.data.foreach_set("value", on_ridge(mesh, positions))
    bpy.context.view_layer.update()
    return cube


def rgba(positions):
    return np.hstack([positions + 0.5, np.ones((len(positions), 1))]).astype(np.float32)


def on_ridge(mesh, rest):
    """Whether each edge is on an edge of the cube, so that both its ends are on the same two sides."""
    ends = rest[read(mesh.edges, "vertices", 2, np.int32)]
    return ((np.abs(ends) > 0.5 - 1e-6).all(axis=1) & (np.abs(ends[:, 0] - ends[:, 1]) < 1e-6)).sum(axis=1) == 2


def deform(recipe):
    bpy.data.texts.new("recipe").write(recipe)
    return bpy.ops.object.isochore_deform(text=bpy.data.texts[-1].name)


def volume(target):
    shape = bmesh.new()
    shape.from_mesh(target.data)
    shape.transform(target.matrix_world)
    return shape.calc_volume(signed=True)


def weights(target, name):
    """Weight of each vertex, or NaN if it is not a member."""
    group = target.vertex_groups[name].index
    found = ([g.weight for g in vertex.groups if g.group == group] for vertex in target.data.vertices)
    return np.array([weight[0] if weight else np.nan for weight in found])


def by_side(target, rest):
    """Rest positions (as rows of an affine fit) and UVs of the first layer for each side of the cube."""
    mesh = target.data
    vertices = read(mesh.loops, "vertex_index", 1, np.int32)
    uvs = read(mesh.uv_layers["UVMap"].data, "uv", 2, np.float32)
    maps = {}
    for polygon in mesh.polygons:
        loops = list(polygon.loop_indices)
        corners = rest[vertices[loops]].astype(float)
        side = tuple(np.where(np.ptp(corners, axis=0) < 1e-6, np.sign(corners[0]), 0))
        rows = np.hstack([corners, np.ones((len(loops), 1))])
        maps.setdefault(side, []).append((rows, uvs[loops]))
    return {side: [np.vstack(part) for part in zip(*rows)] for side, rows in maps.items()}


def test_all_attributes_are_kept(cube):
    mesh = cube.data
    before = volume(cube)
    rest = read(mesh.vertices, "co", 3, np.float32)
    old_weights = {name: weights(cube, name) for name in ["right", "top"]}
    sides = {side: np.linalg.lstsq(*rows, rcond=None)[0] for side, rows in by_side(cube, rest).items()}
    assert deform(BALL) == {"FINISHED"}
    assert len(mesh.polygons) > 1000 and not mesh.validate(verbose=True)
    positions = read(mesh.vertices, "co", 3, np.float32)
    # Positions with 24 bits have an error of at most 6e-8. Over an area of 24, that is at most 1.4e-6 of a volume of 8.
    assert volume(cube) == pytest.approx(before, rel=2e-7)

    # Colors encode the position at rest, so they identify the source of every vertex.
    colors = read(mesh.color_attributes["painted"].data, "color", 4, np.float32)
    old, now_rest = len(rest), colors[:, :3] - 0.5
    assert np.array_equal(colors[:old], rgba(rest))
    moved = np.abs(positions - now_rest).max(axis=1)
    assert moved.max() > 0.05
    assert np.array_equal(positions[:old][rest[:, 2] < 0], rest[rest[:, 2] < 0])
    loops = read(mesh.loops, "vertex_index", 1, np.int32)
    assert read(mesh.color_attributes["corners"].data, "color", 4, np.float32) == pytest.approx(colors[loops], abs=1e-6)
    second = mesh.uv_layers["second"]
    assert read(second.data, "uv", 2, np.float32) == pytest.approx(now_rest[loops, :2] * [1, 0.5], abs=1e-6)
    assert [layer.name for layer in mesh.uv_layers] == ["UVMap", "second"] and second.active_render

    after = by_side(cube, now_rest)
    assert set(after) == set(sides)
    for side, (rows, uvs) in after.items():
        assert uvs == pytest.approx(rows @ sides[side], abs=1e-5), "a corner left its island"

    for name, expected in old_weights.items():
        now = weights(cube, name)
        assert np.array_equal(now[:old], expected, equal_nan=True)
        assert np.nanmin(now) >= 0 and np.nanmax(now) <= 1 and np.isfinite(now[old:]).any()

    assert [material.name for material in mesh.materials] == ["sides", "top"]
    for polygon in mesh.polygons:
        assert polygon.material_index == int((now_rest[list(polygon.vertices), 2] > 0.5 - 1e-6).all())
    assert np.array_equal(read(mesh.attributes["sharp_edge"].data, "value", 1, bool), on_ridge(mesh, now_rest))


def test_a_mirrored_object(cube):
    cube.scale = (-2, 2, 2)
    cube.rotation_euler = (0, 0, 0.3)
    bpy.context.view_layer.update()
    before = volume(cube)
    assert before < 0
    rest = read(cube.data.vertices, "co", 3, np.float32)
    assert deform(BALL) == {"FINISHED"}
    assert volume(cube) == pytest.approx(before, rel=2e-7)
    mesh = cube.data
    colors = read(mesh.color_attributes["painted"].data, "color", 4, np.float32)
    assert len(colors) > len(rest) and np.array_equal(colors[: len(rest)], rgba(rest))
    loops = read(mesh.loops, "vertex_index", 1, np.int32)
    assert read(mesh.color_attributes["corners"].data, "color", 4, np.float32) == pytest.approx(colors[loops], abs=1e-6)


def test_a_loose_vertex_stays(cube):
    cube.data.vertices.add(1)
    cube.data.vertices[-1].co = (0, 0, -5)
    cube.vertex_groups["right"].add([len(cube.data.vertices) - 1], 0.25, "REPLACE")
    loose = len(cube.data.vertices) - 1
    assert deform(BALL) == {"FINISHED"}
    assert tuple(cube.data.vertices[loose].co) == (0, 0, -5) and weights(cube, "right")[loose] == 0.25


def test_polygons_are_kept_without_refinement(cube):
    rest = read(cube.data.vertices, "co", 3, np.float32)
    assert deform(BALL.replace("max_edge = 0.25", "enabled = false")) == {"FINISHED"}
    assert {len(polygon.vertices) for polygon in cube.data.polygons} == {4}
    assert not np.array_equal(read(cube.data.vertices, "co", 3, np.float32), rest)


def test_a_recipe_from_a_file(cube, tmp_path):
    (tmp_path / "ball.toml").write_text(BALL)
    assert bpy.ops.object.isochore_deform(filepath=str(tmp_path / "ball.toml")) == {"FINISHED"}
    assert len(cube.data.polygons) > 1000


@pytest.mark.parametrize(
    ("recipe", "message"),
    [
        (BALL.replace("radius", "radios"), "radi"),
        ("recipe = ", "Invalid value"),
        (BALL.replace("keys", "kees"), "kees"),
    ],
)
def test_invalid_recipes_are_reported(cube, recipe, message):
    rest = read(cube.data.vertices, "co", 3, np.float32)
    with pytest.raises(RuntimeError, match=message):
        deform(recipe)
    assert np.array_equal(read(cube.data.vertices, "co", 3, np.float32), rest)


def test_rejects_shape_keys(cube):
    cube.shape_key_add(name="Basis")
    with pytest.raises(RuntimeError, match="shape keys"):
        deform(BALL)


@pytest.mark.parametrize("refine", [True, False])
@pytest.mark.parametrize("scale", [(2, 2, 2), (-2, 2, 2)])
def test_custom_normals_rotate_with_the_surface(cube, refine, scale):
    cube.scale = scale
    bpy.context.view_layer.update()
    mesh = cube.data
    mesh.attributes.remove(mesh.attributes["sharp_edge"])
    rest = read(mesh.vertices, "co", 3, np.float32)
    radial = rest[read(mesh.loops, "vertex_index", 1, np.int32)]
    mesh.normals_split_custom_set((radial / np.linalg.norm(radial, axis=1, keepdims=True)).tolist())
    assert deform(BALL if refine else BALL.replace("max_edge = 0.25", "enabled = false")) == {"FINISHED"}
    assert mesh.has_custom_normals and (len(mesh.polygons) > 1000) == refine
    normals = read(mesh.corner_normals, "vector", 3, np.float32)
    vertices = read(mesh.loops, "vertex_index", 1, np.int32)
    old = vertices < len(rest)
    before = rest[vertices[old]] / np.linalg.norm(rest[vertices[old]], axis=1, keepdims=True)
    along = (normals[old] * before).sum(axis=1)
    # Normals of unmoved vertices are unchanged up to Blender's 16 bits. Normals at the ball are tilted.
    assert along[rest[vertices[old], 2] < 0] == pytest.approx(1, abs=1e-3) and along.min() < 0.99
    # No normal points to the other side.
    facing = [polygon.normal.dot(Vector(normals[loop])) for polygon in mesh.polygons for loop in polygon.loop_indices]
    assert min(facing) > 0


def test_undo(cube):
    name, count = cube.name, len(cube.data.polygons)
    bpy.ops.ed.undo_push(message="before")
    deform(BALL)
    bpy.ops.ed.undo_push(message="deform")
    assert len(bpy.data.objects[name].data.polygons) > count
    bpy.ops.ed.undo()
    assert len(bpy.data.objects[name].data.polygons) == count
