import numpy as np
import pytest

import isochore


def skinned_ball(columns):
    """A ball whose vertices each have `columns` of six joints, with decreasing weights."""
    shape = {"kind": "icosphere", "radius": 1.0, "subdivisions": 4}
    ball = isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh
    count = len(ball.positions)
    joints = (np.arange(count)[:, None] + np.arange(columns)) % 6
    weights = np.tile(np.arange(columns, 0, -1.0), (count, 1))
    return isochore.Mesh(ball.positions, ball.triangles, skin=(joints, weights)), joints, weights


@pytest.mark.parametrize("columns", [1, 4])
def test_inserted_vertices_have_the_joints_of_their_parents(columns):
    ball, joints, weights = skinned_ball(columns)
    original = ball.skin
    assert np.array_equal(original[0], joints) and original[1] == pytest.approx(weights / weights.sum(axis=1, keepdims=True))
    session = isochore.Session(ball)
    session.begin_stroke(isochore.Tool({"shape": {"kind": "sphere", "radius": 0.3}, "support": 0.4}), longest_edge=0.05)
    for height in np.linspace(1.5, 1.1, 5):
        session.move_to([0, 0, height])
    session.end_stroke()
    refined, numbers = session.export()
    now_joints, now_weights = refined.skin
    assert now_joints.shape == now_weights.shape == (len(refined.positions), columns)
    # Each weight is rounded once, and a few weights are summed.
    assert now_weights.sum(axis=1) == pytest.approx(1, abs=1e-15 * columns) and now_weights.min() >= 0

    old = numbers < len(joints)
    assert np.array_equal(now_joints[old], joints[numbers[old]]) and np.array_equal(now_weights[old], original[1][numbers[old]])
    assert (~old).sum() > 50
    triangles, coordinates = session.origins()
    for vertex in np.flatnonzero(~old):
        # Without seams, an inserted vertex has one render vertex of the same number.
        number = numbers[vertex]
        parents = ball.triangles[triangles[number]][coordinates[number] > 0]
        used = now_joints[vertex][now_weights[vertex] > 0]
        assert set(used) <= set(joints[parents].ravel()) and len(set(used)) == len(used)


def test_a_recipe_keeps_the_skin():
    ball, _, _ = skinned_ball(4)
    stroke = {"kind": "twist", "origin": [0, 0, 0], "axis": [0, 0, 1], "degrees_per_unit": 60.0}
    recipe = {"recipe": 1, "target": {"mesh": "ball"}, "stroke": [stroke], "refine": {"max_edge": 0.08}}
    mesh = isochore.run(recipe, meshes={"ball": ball}).mesh
    assert len(mesh.positions) > len(ball.positions)
    assert mesh.skin[0].shape == (len(mesh.positions), 4)
    assert mesh.skin[1].sum(axis=1) == pytest.approx(1, abs=4e-15)


def test_entries_of_weight_zero_are_dropped():
    joints = [[5, 6], [7, 9], [0, 0]]
    mesh = isochore.Mesh(np.eye(3), [[0, 1, 2]], skin=(joints, [[2, 0], [0, 1], [0, 0]]))
    assert np.array_equal(mesh.skin[0], [[5], [9], [0]]) and np.array_equal(mesh.skin[1], [[1], [1], [0]])
    assert isochore.Mesh(np.eye(3), [[0, 1, 2]]).skin is None


@pytest.mark.parametrize(
    "joints, weights, words",
    [
        (np.zeros((2, 4), int), np.ones((2, 4)), "joints must have the shape"),
        (np.zeros((3, 4), int), np.ones((3, 3)), "weights must have the shape"),
        (np.zeros((3, 0), int), np.ones((3, 0)), "0 influences each"),
        (np.zeros((3, 4)), np.ones((3, 4)), "joints must be integers"),
        (np.full((3, 4), -1), np.ones((3, 4)), "-1 is not a valid index"),
        (np.zeros((3, 4), int), np.full((3, 4), np.nan), "skin of vertex 0"),
        (np.zeros((3, 4), int), np.full((3, 4), -1.0), "not negative"),
    ],
)
def test_rejects_invalid_skins(joints, weights, words):
    with pytest.raises(ValueError, match=words):
        isochore.Mesh(np.eye(3), [[0, 1, 2]], skin=(joints, weights))
