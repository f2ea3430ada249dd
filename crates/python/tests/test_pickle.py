"""Pickling and copying of meshes."""

import copy
import pickle

import numpy as np
import pytest

import isochore

ARRAYS = ["positions", "triangles", "normals", "colors", "corner_colors", "triangle_materials"]


@pytest.fixture
def mesh():
    """A mesh with all attributes."""
    generator = np.random.default_rng(1)
    ball = isochore.run({"recipe": 1, "target": {"shape": {"kind": "icosphere", "radius": 1, "subdivisions": 2}}, "stroke": []})
    positions, triangles = ball.mesh.positions, ball.mesh.triangles
    corners = (len(triangles), 3)
    return isochore.Mesh(
        positions,
        triangles,
        uvs=[generator.random((*corners, 2)), generator.random((*corners, 2))],
        normals=generator.standard_normal((*corners, 3)),
        colors=generator.random((len(positions), 4)),
        corner_colors=generator.random((*corners, 4)),
        skin=(generator.integers(5, size=(len(positions), 3)), generator.random((len(positions), 3))),
        materials=["bark", "leaf"],
        triangle_materials=generator.integers(2, size=len(triangles)),
    )


def test_pickling_keeps_every_bit(mesh):
    bare = isochore.Mesh(mesh.positions, mesh.triangles)
    for original in [mesh, bare]:
        again = pickle.loads(pickle.dumps(original))
        for name in ARRAYS:
            one, two = getattr(original, name), getattr(again, name)
            assert (one is None) == (two is None) and (one is None or np.array_equal(one, two)), name
        assert len(again.uvs) == len(original.uvs) and all(map(np.array_equal, again.uvs, original.uvs))
        assert again.materials == original.materials
    assert all(map(np.array_equal, pickle.loads(pickle.dumps(mesh)).skin, mesh.skin))


def test_pickling_keeps_the_metadata_of_a_file(mesh):
    read = isochore.Mesh.from_bytes(mesh.to_bytes("glb"), "glb")
    assert pickle.loads(pickle.dumps(read)).to_bytes("glb") == read.to_bytes("glb")


def test_a_mesh_is_its_own_copy(mesh):
    assert copy.copy(mesh) is mesh and copy.deepcopy([mesh])[0] is mesh


def test_rejects_invalid_pickled_data(mesh):
    restore, (parts,) = mesh.__reduce__()
    for change in [{"uvs": [b""]}, {"normals": parts["normals"][:36]}, {"materials": []}, {"skin_counts": parts["skin_counts"][:4]}]:
        with pytest.raises(ValueError, match="not a valid mesh"):
            restore({**parts, **change})
    with pytest.raises(isochore.Error, match="names vertex"):
        restore({**parts, "positions": parts["positions"][:24]})
