import numpy as np
import pytest
import trimesh

import isochore


@pytest.fixture
def cube():
    return isochore.Mesh.from_trimesh(trimesh.creation.box())


def test_arrays_are_views_of_the_mesh(cube):
    assert cube.positions.shape == (8, 3) and cube.positions.dtype == np.float64
    assert cube.triangles.shape == (12, 3) and cube.triangles.dtype == np.uint32
    for name in ["positions", "triangles"]:
        first, second = getattr(cube, name), getattr(cube, name)
        assert np.shares_memory(first, second)
        with pytest.raises(ValueError):
            first[0] = 0
        with pytest.raises(ValueError):
            first.flags.writeable = True


def test_views_outlive_their_mesh():
    positions = isochore.Mesh(np.eye(3), [[0, 1, 2]]).positions
    # These arrays would overwrite freed memory.
    fillers = [np.full(9, 7.0) for _ in range(100)]
    assert np.array_equal(positions, np.eye(3)) and len(fillers) == 100


def test_measures(cube):
    assert cube.is_closed
    assert cube.volume == pytest.approx(1, abs=1e-15)
    assert cube.area == pytest.approx(6, abs=1e-14)
    assert np.array_equal(cube.bounds, [[-0.5] * 3, [0.5] * 3])
    assert cube.self_intersections().size == 0


def test_round_trip_through_trimesh(cube):
    exported = cube.to_trimesh()
    assert exported.is_watertight and exported.volume == pytest.approx(1, abs=1e-14)
    back = isochore.Mesh.from_trimesh(exported)
    assert np.array_equal(back.positions, cube.positions) and np.array_equal(back.triangles, cube.triangles)


def test_accepts_any_array_layout():
    fortran = np.asfortranarray(np.arange(9.0).reshape(3, 3))
    for positions in [fortran, fortran.astype(np.float32), fortran.tolist(), np.arange(18.0).reshape(3, 6)[:, ::2]]:
        mesh = isochore.Mesh(positions, np.array([[0, 1, 2]], dtype=np.int16))
        assert np.array_equal(mesh.positions, np.asarray(positions, dtype=float))


@pytest.mark.parametrize(
    "positions, triangles, words",
    [
        (np.zeros((3, 2)), [[0, 1, 2]], "positions must have the shape (N, 3)"),
        (np.eye(3), [0, 1, 2], "triangles must have the shape (N, 3)"),
        (np.eye(3), [[0.0, 1.0, 2.0]], "triangles must be integers"),
        (np.eye(3), [[0, 1, -1]], "triangle 0"),
        (np.eye(3), [[0, 1, 2**32]], "triangle 0"),
    ],
)
def test_rejects_invalid_arrays(positions, triangles, words):
    with pytest.raises(ValueError) as caught:
        isochore.Mesh(positions, triangles)
    assert words in str(caught.value)


def test_rejects_invalid_meshes():
    with pytest.raises(isochore.Error, match="triangle 0 names vertex 3"):
        isochore.Mesh(np.eye(3), [[0, 1, 3]])
    with pytest.raises(isochore.Error, match="vertex 1"):
        isochore.Mesh([[0, 0, 0], [np.nan, 0, 0], [0, 1, 0]], [[0, 1, 2]])


def test_rejects_objects_that_are_not_meshes():
    for call in [isochore.Session, isochore.DistanceField, isochore.Mesh.from_trimesh]:
        with pytest.raises(TypeError, match="vertices and faces, not int"):
            call(5)


def test_attributes_are_kept():
    uvs = np.arange(6.0).reshape(1, 3, 2) / 10
    colors = np.linspace(0, 1, 12).reshape(3, 4)
    normals = np.array([[[2, 0, 0], [0, 3, 0], [3, 0, 4]]])
    mesh = isochore.Mesh(np.eye(3), [[0, 1, 2]], uvs=[uvs], normals=normals, colors=colors)
    assert mesh.uvs[0].dtype == np.float32 and np.array_equal(mesh.uvs, [uvs.astype(np.float32)])
    assert np.array_equal(mesh.colors, colors)
    # Half an ulp of single precision.
    assert mesh.normals.dtype == np.float32
    assert mesh.normals == pytest.approx(np.array([[[1, 0, 0], [0, 1, 0], [0.6, 0, 0.8]]]), abs=3e-8)
    bare = isochore.Mesh(np.eye(3), np.array([[0, 1, 2]])[::-1])
    assert bare.uvs == [] and bare.normals is None and bare.colors is None
    with pytest.raises(ValueError, match="zero or not finite"):
        isochore.Mesh(np.eye(3), [[0, 1, 2]], normals=np.zeros((1, 3, 3)))
    with pytest.raises(ValueError, match="normals must have the shape"):
        isochore.Mesh(np.eye(3), [[0, 1, 2]], normals=np.ones((3, 3)))
    with pytest.raises(ValueError, match="uvs"):
        isochore.Mesh(np.eye(3), [[0, 1, 2]], uvs=[np.full((1, 3, 2), np.nan)])
    with pytest.raises(ValueError, match="colors"):
        isochore.Mesh(np.eye(3), [[0, 1, 2]], colors=np.full((3, 4), np.inf))


def test_materials_are_kept_and_written_to_files(cube):
    numbers = [0] * 6 + [2] * 6
    mesh = isochore.Mesh(cube.positions, cube.triangles, materials=["bark", "", "leaf"], triangle_materials=numbers)
    assert mesh.materials == ["bark", "", "leaf"] and mesh.triangle_materials.tolist() == numbers
    assert mesh.triangle_materials.dtype == np.uint32 and np.shares_memory(mesh.triangle_materials, mesh.triangle_materials)
    assert cube.materials == [] and cube.triangle_materials is None
    read = isochore.Mesh.from_bytes(mesh.to_bytes("glb"), "glb")
    names = np.array(read.materials)[read.triangle_materials]
    # The file groups triangles by material.
    assert sorted(names) == ["bark"] * 6 + ["leaf"] * 6
    # Each part of a refined triangle keeps the material.
    stroke = {"kind": "twist", "origin": [0, 0, 0], "axis": [0, 0, 1], "degrees_per_unit": 60.0}
    recipe = {"recipe": 1, "target": {"mesh": "cube"}, "stroke": [stroke], "refine": {"max_edge": 0.3}}
    twisted, rest, _ = isochore.run(recipe, meshes={"cube": mesh})
    area = lambda chosen: isochore.Mesh(rest.positions, rest.triangles[chosen]).area
    assert twisted.materials == mesh.materials and len(twisted.triangles) > 100
    assert [area(twisted.triangle_materials == number) for number in (0, 2)] == pytest.approx([3, 3], abs=1e-13)


@pytest.mark.parametrize(
    "given, words",
    [
        ({"materials": ["a"]}, "materials require triangle_materials"),
        ({"triangle_materials": [0]}, "triangle 0 has material 0, but there are 0 materials"),
        ({"materials": ["a"], "triangle_materials": [1]}, "triangle 0 has material 1, but there are 1 materials"),
        ({"materials": ["a"], "triangle_materials": [-1]}, "triangle 0 has material -1, but there are 1 materials"),
        ({"materials": ["a"], "triangle_materials": [0, 0]}, r"triangle_materials must have the shape \(1\)"),
        ({"materials": ["a"], "triangle_materials": [0.5]}, "triangle_materials must be integers"),
        ({"corner_colors": np.zeros((3, 4))}, r"corner_colors must have the shape \(1, 3, 4\)"),
        ({"corner_colors": np.full((1, 3, 4), np.nan)}, "corner_colors: the number at 0 is not finite"),
    ],
)
def test_rejects_invalid_attributes(given, words):
    with pytest.raises(ValueError, match=words):
        isochore.Mesh(np.eye(3), [[0, 1, 2]], **given)


def test_normals_rotate_with_the_surface(cube):
    flat = np.cross(*(cube.positions[cube.triangles[:, side]] - cube.positions[cube.triangles[:, 0]] for side in (1, 2)))
    mesh = isochore.Mesh(cube.positions, cube.triangles, normals=np.repeat(flat, 3, axis=0).reshape(-1, 3, 3))
    stroke = {"kind": "twist", "origin": [0, 0, 0], "axis": [0, 0, 1], "degrees_per_unit": 60.0}
    recipe = {"recipe": 1, "target": {"mesh": "cube"}, "stroke": [stroke], "refine": {"enabled": False}, "volume": {"lock": False}}
    turned = isochore.run(recipe, meshes={"cube": mesh}).mesh
    # The top rotates by 30 degrees in its own plane, so its normals do not change.
    top = np.all(cube.positions[cube.triangles][:, :, 2] == 0.5, axis=1)
    assert turned.normals[top] == pytest.approx(np.broadcast_to([0, 0, 1.0], (2, 3, 3)), abs=1e-12)
    # Three components rounded to single precision, and their squares and sums as well.
    assert np.linalg.norm(turned.normals, axis=2) == pytest.approx(np.ones((12, 3)), abs=3e-7)
    assert not np.allclose(turned.normals[~top], mesh.normals[~top])


def test_an_empty_mesh():
    empty = isochore.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert empty.positions.shape == empty.triangles.shape == (0, 3)
    with pytest.raises(ValueError, match="string"):
        isochore.Mesh([["a", "b", "c"]], [[0, 0, 0]])


def test_files(cube, tmp_path):
    cube.write(tmp_path / "cube.obj")
    read = isochore.Mesh.read(tmp_path / "cube.obj")
    assert np.array_equal(read.positions, cube.positions)
    assert (tmp_path / "cube.obj").read_bytes() == cube.to_bytes("obj")
    again = isochore.Mesh.from_bytes(cube.to_bytes("ply"), "ply")
    assert np.array_equal(again.triangles, cube.triangles)
    with pytest.raises(FileNotFoundError, match="absent.obj"):
        isochore.Mesh.read(tmp_path / "absent.obj")
    with pytest.raises(ValueError, match="`doc` is not a mesh format"):
        cube.to_bytes("doc")


def test_distance_of_a_cube(cube):
    field = isochore.DistanceField(cube, 32)
    assert field.samples.dtype == np.float32 and field.samples.ndim == 3
    distances, gradients = field([[0, 0, 0.5], [0.1, -0.1, 0.4]])
    # The disturbance of the spline by the kink at medial surfaces, six nodes away, decays by a factor of 0.27 per node.
    # So does the disturbance by the border of the grid, eight nodes away.
    rest = 0.27**6 / 32
    assert distances == pytest.approx([0, -0.1], abs=rest)
    assert gradients == pytest.approx(np.array([[0, 0, 1.0], [0, 0, 1]]), abs=32 * rest)
    node = np.array([3, 4, 5])
    position = field.origin + field.cell * node[::-1]
    assert field(position[None])[0][0] == pytest.approx(field.samples[tuple(node)], abs=1e-6)
