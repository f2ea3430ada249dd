"""A textured, skinned cylinder is written to GLB, deformed with refinement, and read back into Blender."""

import json
import math
import pathlib
import struct

import bpy  # before bmesh and mathutils, which come with it
import bmesh
import isochore
import numpy as np
import pytest
from isochore_blender.surface import read
from mathutils import Matrix, Quaternion, Vector
from mathutils.bvhtree import BVHTree

PICTURES = pathlib.Path(__file__).resolve().parents[3] / "target" / "blender" / "pictures"
"""Folder of pictures before and after, at rest and posed, for visual inspection."""

SEGMENTS, RINGS = 32, 12

SIZE = 200, 240
"""Width and height of the pictures."""

CAMERA = Matrix.Translation((1.2, -4.2, 1.6)) @ Vector((1.2, -4.2, 1.5)).to_track_quat("Z", "Y").to_matrix().to_4x4()

TURN = Quaternion((0, 1, 0), math.radians(30))
"""Rotation of the upper bone."""

COLORS = {
    "yellow": (0.79, 0.6, 0.033),
    "blue": (0.01, 0.073, 0.45),
    "green": (0.2, 0.6, 0.25),
    "red": (0.6, 0.01, 0.01),
    "inside": (1, 0, 1),
}
"""Linear RGB of the texture, of the other material, and of the inside of the surface."""

RECIPE = {
    "recipe": 1,
    "tools": {"ball": {"shape": {"kind": "sphere", "radius": 0.35}, "support": 0.3}},
    # glTF has y up. The ball comes from the direction of the camera.
    "stroke": [{"kind": "move", "tool": "ball", "keys": [{"at": [0, 0.3, 1.2]}, {"at": [0, 0.3, 0.65]}]}],
    "refine": {"max_edge": 0.06},
    "promise": {"volume": 1e-6},
}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The GLB file that Blender wrote, the deformed file, and the result."""
    folder = tmp_path_factory.mktemp("gltf")
    empty_scene()
    draw_cylinder()
    before, after = folder / "before.glb", folder / "after.glb"
    bpy.ops.export_scene.gltf(filepath=str(before), export_format="GLB", export_animations=False)
    result = isochore.run({**RECIPE, "target": {"mesh": str(before)}})
    result.mesh.write(after)
    return before, after, result


def empty_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")


def draw_cylinder():
    """Creates a cylinder of height 2 about z on two bones, with a checkered side and plain caps."""
    shape = bmesh.new()
    angles = [2 * math.pi * i / SEGMENTS for i in range(SEGMENTS)]
    heights = [2 * j / RINGS - 1 for j in range(RINGS + 1)]
    rings = [[shape.verts.new((0.5 * math.cos(a), 0.5 * math.sin(a), z)) for a in angles] for z in heights]
    uvs = shape.loops.layers.uv.new("UVMap")
    for j in range(RINGS):
        for i in range(SEGMENTS):
            next_i = (i + 1) % SEGMENTS
            face = shape.faces.new([rings[j][i], rings[j][next_i], rings[j + 1][next_i], rings[j + 1][i]])
            face.smooth = True
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            for loop, (across, up) in zip(face.loops, corners, strict=True):
                loop[uvs].uv = across / SEGMENTS, up / RINGS
    for ring, z in [(rings[0][::-1], -1), (rings[-1], 1)]:
        middle = shape.verts.new((0, 0, z))
        for i in range(SEGMENTS):
            shape.faces.new([ring[i], ring[(i + 1) % SEGMENTS], middle]).material_index = 1
    mesh = bpy.data.meshes.new("cylinder")
    shape.to_mesh(mesh)
    cylinder = bpy.data.objects.new("cylinder", mesh)
    bpy.context.collection.objects.link(cylinder)
    mesh.materials.append(material("checked", checks()))
    mesh.materials.append(material("plain", None))

    armature = bpy.data.objects.new("armature", bpy.data.armatures.new("armature"))
    bpy.context.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    lower, upper = (armature.data.edit_bones.new(name) for name in ["lower", "upper"])
    lower.head, lower.tail = (0, 0, -1), (0, 0, 0)
    upper.head, upper.tail, upper.parent = (0, 0, 0), (0, 0, 1), lower
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, sign in [("lower", -1), ("upper", 1)]:
        group = cylinder.vertex_groups.new(name=name)
        for vertex in mesh.vertices:
            group.add([vertex.index], min(max(0.5 + sign * vertex.co.z, 0), 1), "REPLACE")
    cylinder.parent = armature
    cylinder.modifiers.new("armature", "ARMATURE").object = armature


def checks():
    """Creates an image of 16 by 8 fields in two colors, and one field in a third color."""
    rows, columns = np.mgrid[0:128, 0:256] // 16
    pixels = np.where(((rows + columns) % 2 == 0)[..., None], [0.9, 0.8, 0.2, 1], [0.1, 0.3, 0.7, 1])
    pixels[(rows == 5) & (columns == 12)] = [0.8, 0.1, 0.1, 1]
    image = bpy.data.images.new("checks", 256, 128)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.pack()
    return image


def material(name, image):
    result = bpy.data.materials.new(name)
    shader = result.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.2, 0.6, 0.25, 1)
    if image:
        texture = result.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        result.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return result


def chunks(path):
    """Returns the JSON and the binary part of a GLB file."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def images(path):
    document, binary = chunks(path)
    views = [document["bufferViews"][image["bufferView"]] for image in document["images"]]
    return [binary[view.get("byteOffset", 0) :][: view["byteLength"]] for view in views]


def accessor(path, index):
    """Numbers of an accessor, one row an element."""
    document, binary = chunks(path)
    at = document["accessors"][index]
    view = document["bufferViews"][at["bufferView"]]
    kind = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[at["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[at["type"]]
    start = view.get("byteOffset", 0) + at.get("byteOffset", 0)
    stride = view.get("byteStride", np.dtype(kind).itemsize * width)
    rows = [np.frombuffer(binary, kind, width, start + i * stride) for i in range(at["count"])]
    return np.array(rows)


def influences(path):
    """By primitive: weights, and joints as names."""
    document, _ = chunks(path)
    names = np.array([document["nodes"][joint]["name"] for joint in document["skins"][0]["joints"]])
    for primitive in (p for mesh in document["meshes"] for p in mesh["primitives"]):
        held = primitive["attributes"]
        assert not any(key.startswith("JOINTS_") and key != "JOINTS_0" for key in held)
        yield accessor(path, held["WEIGHTS_0"]).astype(float), names[accessor(path, held["JOINTS_0"])]


def test_the_document_is_kept(files):
    before, after, result = files
    old, new = chunks(before)[0], chunks(after)[0]
    assert images(after) == images(before)
    assert [m["name"] for m in new["materials"]] == [m["name"] for m in old["materials"]] == ["checked", "plain"]
    assert new["materials"] == old["materials"] and new["textures"] == old["textures"]

    def triangles(path, document):
        counts = {}
        for primitive in (p for mesh in document["meshes"] for p in mesh["primitives"]):
            name = document["materials"][primitive["material"]]["name"]
            counts[name] = counts.get(name, 0) + len(accessor(path, primitive["indices"])) // 3
        return counts

    assert triangles(before, old) == {"checked": 2 * SEGMENTS * RINGS, "plain": 2 * SEGMENTS}
    counts = triangles(after, new)
    assert sum(counts.values()) == result.report["after"]["triangles"] > 3 * sum(triangles(before, old).values())
    assert set(counts) == {"checked", "plain"}

    def joints(path, document):
        named = [document["nodes"][joint] for joint in document["skins"][0]["joints"]]
        binds = accessor(path, document["skins"][0]["inverseBindMatrices"])
        keys = ["name", "translation", "rotation", "scale"]
        return [[node.get(key) for key in keys] for node in named], binds.tolist()

    assert joints(after, new) == joints(before, old)
    assert any("mesh" in node and "skin" in node for node in new["nodes"])


def test_weights_belong_to_the_same_joints(files):
    before, after, _ = files
    most = max(int((weights > 0).sum(axis=1).max()) for weights, _ in influences(before))
    for weights, joints in influences(after):
        assert weights.min() >= 0 and (weights > 0).sum(axis=1).max() <= most
        # Rounding error of four numbers in single precision.
        assert weights.sum(axis=1) == pytest.approx(1, abs=4e-7)
        assert set(joints[weights > 0]) <= {"lower", "upper"}


def imported(path):
    """Imports a file into an empty scene. Returns its mesh and its armature."""
    empty_scene()
    bpy.ops.import_scene.gltf(filepath=str(path), merge_vertices=True)
    kinds = {thing.type: thing for thing in bpy.data.objects if thing.name != "Icosphere"}
    return kinds["MESH"], kinds["ARMATURE"]


def posed(cylinder, armature):
    """Returns positions in world space with the upper bone rotated by `TURN`."""
    bone = armature.pose.bones["upper"]
    bone.rotation_mode = "QUATERNION"
    frame = bone.bone.matrix_local.to_quaternion()
    bone.rotation_quaternion = frame.inverted() @ TURN @ frame
    bpy.context.view_layer.update()
    shown = cylinder.evaluated_get(bpy.context.evaluated_depsgraph_get())
    positions = read(shown.data.vertices, "co", 3, np.float32)
    return positions @ np.array(cylinder.matrix_world)[:3, :3].T + np.array(cylinder.matrix_world)[:3, 3]


def blended(rest, weights):
    """Linear blend skinning with the weights of the upper bone."""
    turned = rest @ np.array(TURN.to_matrix()).T
    return rest + weights[:, None] * (turned - rest)


@pytest.mark.parametrize("which", ["before", "after"])
def test_blender_poses_the_file(files, which):
    cylinder, armature = imported(files[which == "after"])
    rest = read(cylinder.data.vertices, "co", 3, np.float32)
    world = np.array(cylinder.matrix_world)
    rest = rest @ world[:3, :3].T + world[:3, 3]
    # Weights that Blender read.
    upper = cylinder.vertex_groups["upper"].index
    weights = np.array([sum(g.weight for g in vertex.groups if g.group == upper) for vertex in cylinder.data.vertices])
    assert posed(cylinder, armature) == pytest.approx(blended(rest, weights), abs=1e-5)
    # Weights are a clamped linear function of the height at rest. Moved vertices keep their weights.
    untouched = rest[:, 2] < -0.4
    assert untouched.any() and weights[untouched] == pytest.approx(np.clip(0.5 + rest[untouched, 2], 0, 1), abs=0.02)
    assert {slot.material.name for slot in cylinder.material_slots} == {"checked", "plain"}
    assert [image.size[:] for image in bpy.data.images if image.name == "checks"] == [(256, 128)]


@pytest.mark.parametrize("is_posed", [False, True])
@pytest.mark.parametrize("which", ["before", "after"])
def test_blender_renders_the_file(files, which, is_posed):
    path = files[which == "after"]
    cylinder, armature = imported(path)
    if is_posed:
        posed(cylinder, armature)
    picture = render(which + "-posed" * is_posed)
    expected = traced(path, is_posed)
    is_covered, seen = picture[..., 3] > 0.5, colors(picture)
    # Pixels on the outline, at borders of fields and at folds have mixed colors, so they are excluded.
    framed = np.pad(expected, 1)
    is_inside = np.ones(expected.shape, bool)
    for up, across in [(0, 1), (1, 0), (1, 2), (2, 1)]:
        is_inside &= expected == framed[up:, across:][: SIZE[1], : SIZE[0]]
    # Fields of at least 16 pixels have borders of 3 pixels, and 40 fields are visible.
    assert is_inside.mean() > 0.9 and is_inside[expected > 0].mean() > 0.6
    assert np.array_equal(is_covered[is_inside], expected[is_inside] > 0), "holes or extra surface"
    is_inside &= is_covered
    assert (seen[is_inside] != expected[is_inside]).mean() < 1e-3
    # Uniform light leaves no pixel black: the deepest points still receive a fiftieth of it.
    assert picture[is_inside][:, :3].max(axis=1).min() > 0.02 ** (1 / 2.2)
    fraction = dict(zip(COLORS, np.bincount(seen[is_inside], minlength=len(COLORS) + 1)[1:] / is_inside.sum(), strict=True))
    assert fraction["yellow"] > 0.2 and fraction["blue"] > 0.2 and fraction["green"] > 0.05
    assert fraction["red"] > 0.01
    assert fraction["inside"] == 0


def render(name):
    """Renders the scene in uniform light, with the inside of the surface in magenta. Returns RGBA rows from the bottom."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.camera.matrix_world = CAMERA
    scene.collection.objects.link(scene.camera)
    scene.world = bpy.data.worlds.new("world")
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    for material in bpy.data.materials:
        show_inside(material)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 16, False
    scene.render.film_transparent, scene.view_settings.view_transform = True, "Standard"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.filepath = str(PICTURES / f"{name}.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(4 * SIZE[0] * SIZE[1], np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(SIZE[1], SIZE[0], 4)


def show_inside(material):
    nodes, links = material.node_tree.nodes, material.node_tree.links
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    inside, mix, side = (nodes.new(f"ShaderNode{kind}") for kind in ["Emission", "MixShader", "NewGeometry"])
    inside.inputs["Color"].default_value = (1, 0, 1, 1)
    links.new(side.outputs["Backfacing"], mix.inputs["Factor"])
    links.new(output.inputs["Surface"].links[0].from_socket, mix.inputs[1])
    links.new(inside.outputs["Emission"], mix.inputs[2])
    links.new(mix.outputs["Shader"], output.inputs["Surface"])


def colors(picture):
    """Returns, for each pixel, the number from 1 of the color in `COLORS` with the closest direction."""
    light = picture[..., :3] ** 2.2
    light /= np.maximum(np.linalg.norm(light, axis=2, keepdims=True), 1e-6)
    directions = np.array(list(COLORS.values()))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.argmax(light @ directions.T, axis=2) + 1


def traced(path, is_posed):
    """Returns the expected color number of each pixel, computed from the arrays of the file; 0 outside the surface."""
    mesh = isochore.Mesh.read(path)
    # glTF has y up.
    positions = mesh.positions @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    if is_posed:
        document, _ = chunks(path)
        names = [document["nodes"][joint]["name"] for joint in document["skins"][0]["joints"]]
        joints, weights = mesh.skin
        positions = blended(positions, (weights * (joints == names.index("upper"))).sum(axis=1))
    tree = BVHTree.FromPolygons(positions.tolist(), mesh.triangles.tolist())
    eye, (right, up, back) = CAMERA.translation, CAMERA.to_3x3().transposed()
    # The camera of Blender has a focal length of 50 by a sensor of 36, over the longer side.
    step = 36 / 50 / max(SIZE)
    seen = np.zeros(SIZE[::-1], int)
    for row, column in np.ndindex(*seen.shape):
        ray = right * step * (column + 0.5 - SIZE[0] / 2) + up * step * (row + 0.5 - SIZE[1] / 2) - back
        point, _, triangle, _ = tree.ray_cast(eye, ray)
        if point is None:
            continue
        a, b, c = positions[mesh.triangles[triangle]]
        if np.cross(b - a, c - a) @ ray > 0:
            seen[row, column] = 5
            continue
        if mesh.materials[mesh.triangle_materials[triangle]] == "plain":
            seen[row, column] = 3
            continue
        coordinates = np.linalg.lstsq(np.stack([b - a, c - a], axis=1), np.array(point) - a, rcond=None)[0]
        u, v = np.array([1 - coordinates.sum(), *coordinates]) @ mesh.uvs[0][triangle]
        # glTF counts image rows from the top.
        across, up_rows = int(u * 16), int((1 - v) * 8)
        seen[row, column] = 4 if (up_rows, across) == (5, 12) else 1 + (up_rows + across) % 2
    return seen
