"""A textured, skinned cylinder goes to a GLB file, through a refined deformation, and back into Blender."""

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
from mathutils import Quaternion, Vector

PICTURES = pathlib.Path(__file__).resolve().parents[3] / "target" / "blender" / "pictures"
"""Before and after, at rest and posed, to be looked at."""

SEGMENTS, RINGS = 32, 12

RECIPE = {
    "recipe": 1,
    "tools": {"ball": {"shape": {"kind": "sphere", "radius": 0.35}, "support": 0.3}},
    # glTF has y up: this comes from where the camera stands.
    "stroke": [{"kind": "move", "tool": "ball", "keys": [{"at": [0, 0.3, 1.2]}, {"at": [0, 0.3, 0.65]}]}],
    "refine": {"max_edge": 0.06},
    "promise": {"volume": 1e-6},
}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The GLB file that Blender wrote, what became of it, and the result."""
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
    """A cylinder of height 2 about z, its side in a checked texture, its caps plain, on two bones."""
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
    """16 by 8 fields of two colors, one in a third color."""
    rows, columns = np.mgrid[0:128, 0:256] // 16
    pixels = np.where(((rows + columns) % 2 == 0)[..., None], [0.9, 0.8, 0.2, 1], [0.1, 0.3, 0.7, 1])
    pixels[(rows == 5) & (columns == 12)] = [0.8, 0.1, 0.1, 1]
    image = bpy.data.images.new("checks", 256, 128)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.pack()
    return image


def material(name, image):
    made = bpy.data.materials.new(name)
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.2, 0.6, 0.25, 1)
    if image:
        texture = made.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        made.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return made


def chunks(path):
    """The JSON and the binary part of a GLB file."""
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


def test_document_keeps_what_it_had(files):
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


def test_weights_are_shares_of_the_same_joints(files):
    before, after, _ = files
    most = max(int((weights > 0).sum(axis=1).max()) for weights, _ in influences(before))
    for weights, joints in influences(after):
        assert weights.min() >= 0 and (weights > 0).sum(axis=1).max() <= most
        # Four numbers of single precision.
        assert weights.sum(axis=1) == pytest.approx(1, abs=4e-7)
        assert set(joints[weights > 0]) <= {"lower", "upper"}


def imported(path):
    """The mesh and the armature of a file, in an empty scene."""
    empty_scene()
    bpy.ops.import_scene.gltf(filepath=str(path), merge_vertices=True)
    kinds = {thing.type: thing for thing in bpy.data.objects if thing.name != "Icosphere"}
    return kinds["MESH"], kinds["ARMATURE"]


def posed(cylinder, armature):
    """Positions in the world with the upper bone turned by 40 degrees about x."""
    bone = armature.pose.bones["upper"]
    bone.rotation_mode = "QUATERNION"
    turn = Quaternion((1, 0, 0), math.radians(40))
    frame = bone.bone.matrix_local.to_quaternion()
    bone.rotation_quaternion = frame.inverted() @ turn @ frame
    bpy.context.view_layer.update()
    shown = cylinder.evaluated_get(bpy.context.evaluated_depsgraph_get())
    positions = read(shown.data.vertices, "co", 3, np.float32)
    return positions @ np.array(cylinder.matrix_world)[:3, :3].T + np.array(cylinder.matrix_world)[:3, 3]


def test_blender_shows_and_poses_it(files):
    before, after, result = files
    for path in [before, after]:
        cylinder, armature = imported(path)
        rest = read(cylinder.data.vertices, "co", 3, np.float32)
        world = np.array(cylinder.matrix_world)
        rest = rest @ world[:3, :3].T + world[:3, 3]
        render(path.stem)
        moved = posed(cylinder, armature)
        render(f"{path.stem}-posed")
        # Linear blend skinning, from the weights that Blender read.
        upper = cylinder.vertex_groups["upper"].index
        share = [sum(g.weight for g in vertex.groups if g.group == upper) for vertex in cylinder.data.vertices]
        turned = rest @ np.array(Quaternion((1, 0, 0), math.radians(40)).to_matrix()).T
        expected = rest + np.array(share)[:, None] * (turned - rest)
        assert moved == pytest.approx(expected, abs=1e-5)
        # Weights were linear in the height at rest, and cut off. What the ball moved has kept those it had.
        untouched = rest[:, 2] < -0.4
        assert untouched.any() and np.array(share)[untouched] == pytest.approx(np.clip(0.5 + rest[untouched, 2], 0, 1), abs=0.02)
        assert {slot.material.name for slot in cylinder.material_slots} == {"checked", "plain"}
        assert [image.size[:] for image in bpy.data.images if image.name == "checks"] == [(256, 128)]
    assert abs(result.report["volume_change"]) < 1e-6


def render(name):
    """Traces a small picture of the scene."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    scene = bpy.context.scene
    if scene.camera is None:
        scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.camera.location = (1.2, -4.2, 1.6)
        scene.camera.rotation_euler = Vector((1.2, -4.2, 1.5)).to_track_quat("Z", "Y").to_euler()
        lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
        lamp.data.energy, lamp.rotation_euler = 3, (0.9, 0.5, 0)
        for thing in [scene.camera, lamp]:
            scene.collection.objects.link(thing)
        scene.world = bpy.data.worlds.new("world")
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 16, False
    scene.render.resolution_x, scene.render.resolution_y = 400, 480
    scene.render.filepath = str(PICTURES / f"{name}.png")
    bpy.ops.render.render(write_still=True)
