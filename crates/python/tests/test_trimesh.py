"""Conversion to trimesh and back. Vertices that trimesh duplicates at seams are single vertices in isochore."""

import numpy as np
import pytest
import trimesh
from trimesh.visual import ColorVisuals, TextureVisuals
from trimesh.visual.material import MultiMaterial, PBRMaterial, SimpleMaterial

import isochore

SEGMENTS, RINGS = 12, 6


def torus():
    """A closed torus unrolled to the unit square: positions, triangles, and texture coordinates by corner."""
    across, up = np.meshgrid(np.arange(SEGMENTS), np.arange(RINGS), indexing="ij")
    a, b = 2 * np.pi * across.ravel() / SEGMENTS, 2 * np.pi * up.ravel() / RINGS
    positions = np.stack([(2 + np.cos(b)) * np.cos(a), (2 + np.cos(b)) * np.sin(a), np.sin(b)], axis=1)
    quad = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    corners = np.stack([across.ravel(), up.ravel()], axis=1)[:, None, None] + quad[[[0, 1, 2], [0, 2, 3]]]
    corners = corners.reshape(-1, 3, 2)
    triangles = (corners[:, :, 0] % SEGMENTS) * RINGS + corners[:, :, 1] % RINGS
    return positions, triangles, corners / np.array([SEGMENTS, RINGS])


@pytest.fixture
def textured():
    positions, triangles, uvs = torus()
    return isochore.Mesh(positions, triangles, uvs=[uvs])


def assert_same(mesh, other):
    assert mesh.is_closed and other.is_closed
    assert np.array_equal(mesh.positions, other.positions) and np.array_equal(mesh.triangles, other.triangles)
    assert len(mesh.uvs) == len(other.uvs) and all(map(np.array_equal, mesh.uvs, other.uvs))
    for name in ["colors", "corner_colors", "triangle_materials"]:
        one, two = getattr(mesh, name), getattr(other, name)
        assert (one is None) == (two is None), name
        assert one is None or np.array_equal(one, two), name
    assert mesh.materials == other.materials


def test_textures_keep_their_seams(textured):
    exported = textured.to_trimesh()
    # One duplicate at each vertex of both seams, and two more at their crossing.
    assert len(exported.vertices) == (SEGMENTS + 1) * (RINGS + 1)
    assert np.array_equal(exported.visual.uv[exported.faces], textured.uvs[0])
    assert np.array_equal(exported.triangles, textured.positions[textured.triangles])
    assert np.array_equal(exported.vertices[: len(textured.positions)], textured.positions)
    assert_same(isochore.Mesh.from_trimesh(exported), textured)


def test_a_textured_trimesh_stays_closed(textured):
    exported = textured.to_trimesh()
    assert not exported.is_watertight
    exported.visual.material = SimpleMaterial(name="bark")
    recipe = {
        "recipe": 1,
        "target": {"mesh": "torus"},
        "stroke": [{"kind": "twist", "origin": [0, 0, 0], "axis": [0, 0, 1], "degrees_per_unit": 30.0}],
        "refine": {"max_edge": 0.4},
    }
    twisted, rest, report = isochore.run(recipe, meshes={"torus": exported})
    assert twisted.is_closed and abs(report["volume_change"]) < 1e-12 and len(twisted.triangles) > len(exported.faces)
    assert twisted.materials == ["bark"] and not twisted.triangle_materials.any()
    # On the torus at rest, both coordinates are angles. A point is in the sector of its flat triangle, so its error is less
    # than one sector. Interpolation across a seam would give errors of up to half the circle.
    u = np.arctan2(rest.positions[:, 1], rest.positions[:, 0])[rest.triangles] / (2 * np.pi)
    apart = (twisted.uvs[0][:, :, 0] - u + 0.5) % 1 - 0.5
    assert np.abs(apart).max() < 1 / SEGMENTS
    assert_same(isochore.Mesh.from_trimesh(twisted.to_trimesh()), twisted)


def test_materials_of_faces(textured):
    numbers = np.arange(len(textured.triangles)) % 2
    for names in [["bark", "leaf"], ["bark", ""]]:
        mesh = isochore.Mesh(
            textured.positions, textured.triangles, uvs=textured.uvs, materials=names, triangle_materials=numbers
        )
        exported = mesh.to_trimesh()
        assert [material.name for material in exported.visual.material] == names
        assert np.array_equal(exported.visual.face_materials, numbers)
        assert_same(isochore.Mesh.from_trimesh(exported), mesh)
    several = MultiMaterial([PBRMaterial(name="a"), PBRMaterial()])
    box = trimesh.creation.box()
    box.visual = TextureVisuals(material=several, face_materials=[0] * 6 + [1] * 6)
    mesh = isochore.Mesh.from_trimesh(box)
    assert mesh.materials == ["a", ""] and mesh.uvs == [] and mesh.triangle_materials.tolist() == [0] * 6 + [1] * 6
    assert_same(isochore.Mesh.from_trimesh(mesh.to_trimesh()), mesh)
    # trimesh removes faces without shortening the list of their materials.
    box.update_faces(np.arange(12) < 7)
    assert isochore.Mesh.from_trimesh(box).materials == []


def test_colors_of_vertices(textured):
    colors = (np.arange(4 * len(textured.positions)).reshape(-1, 4) % 256).astype(np.uint8)
    mesh = isochore.Mesh(textured.positions, textured.triangles, colors=colors / 255)
    exported = mesh.to_trimesh()
    assert exported.is_watertight and np.array_equal(exported.visual.vertex_colors, colors)
    assert_same(isochore.Mesh.from_trimesh(exported), mesh)
    # If the mesh has a texture, trimesh stores colors as a vertex attribute.
    both = isochore.Mesh(textured.positions, textured.triangles, uvs=textured.uvs, colors=colors / 255)
    assert_same(isochore.Mesh.from_trimesh(both.to_trimesh()), both)


def test_colors_that_differ_across_a_seam(textured):
    # The texture as a color, which jumps from 1 to 0 at the seams.
    colors = np.dstack([np.rint(textured.uvs[0].astype(float) * 255) / 255, np.ones((*textured.triangles.shape, 2))])
    mesh = isochore.Mesh(textured.positions, textured.triangles, corner_colors=colors)
    exported = mesh.to_trimesh()
    assert exported.visual.kind == "vertex" and len(exported.vertices) == (SEGMENTS + 1) * (RINGS + 1)
    assert_same(isochore.Mesh.from_trimesh(exported), mesh)


def test_colors_of_faces():
    box = trimesh.creation.box()
    box.visual = ColorVisuals(box, face_colors=np.arange(36).reshape(12, 3))
    mesh = isochore.Mesh.from_trimesh(box)
    assert mesh.is_closed and mesh.colors is None
    assert np.array_equal(mesh.corner_colors[:, 2, :3], np.arange(36).reshape(12, 3) / 255)
    exported = mesh.to_trimesh()
    assert exported.visual.kind == "face" and np.array_equal(exported.visual.face_colors, box.visual.face_colors)
    assert exported.is_watertight
    assert_same(isochore.Mesh.from_trimesh(exported), mesh)


def test_float_colors_and_colors_without_alpha():
    box = trimesh.creation.box()
    box.visual = TextureVisuals(uv=box.vertices[:, :2], material=SimpleMaterial())
    box.visual.vertex_attributes["color"] = np.full((8, 3), 0.25, np.float32)
    assert np.array_equal(isochore.Mesh.from_trimesh(box).colors, np.tile([0.25, 0.25, 0.25, 1], (8, 1)))
    box.visual.vertex_attributes["color"] = np.full((8, 4), 0x3333, np.uint16)
    assert isochore.Mesh.from_trimesh(box).colors == pytest.approx(np.full((8, 4), 0.2), abs=1e-15)


def test_a_mesh_without_colors_keeps_its_vertices():
    # Two triangles that touch along an edge but do not have common vertices.
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    apart = trimesh.Trimesh(vertices, [[0, 1, 2], [3, 4, 5]], process=False)
    assert np.array_equal(isochore.Mesh.from_trimesh(apart).positions, vertices)
    assert len(isochore.Mesh.from_trimesh(apart).welded().positions) == 4
