import numpy as np
import pytest

import isochore


@pytest.fixture
def ball():
    shape = {"kind": "icosphere", "radius": 1.0, "subdivisions": 4}
    return isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh


def pressed(session):
    """Moves a ball through the north pole. Returns the positions of the vertices."""
    session.begin_stroke(isochore.Tool({"shape": {"kind": "sphere", "radius": 0.3}, "support": 0.4}), refine=False)
    for height in np.linspace(1.5, 1.1, 5):
        session.move_to([0, 0, height])
    session.end_stroke()
    exported, _ = session.export()
    return exported.positions


def moved(session, ball):
    return np.any(pressed(session) != ball.positions, axis=1)


@pytest.mark.parametrize("kind", [np.float64, np.float32, bool])
def test_masked_vertices_keep_their_bits(ball, kind):
    held = ball.positions[:, 0] < 0
    free = moved(isochore.Session(ball), ball)
    masked = moved(isochore.Session(ball, mask=held.astype(kind)), ball)
    assert np.any(free & held) and not np.any(masked & held)
    assert np.any(masked) and not np.any(masked & ~free)


def test_a_mask_table_of_a_recipe(ball):
    held = (ball.positions[:, 0] < 0).astype(float)
    whole = pressed(isochore.Session(ball, mask={"vertices": held, "fade": 0.25}))
    session = isochore.Session(ball, mask={"vertices": held.tolist(), "fade": np.float32(0.25)})
    assert np.array_equal(pressed(session), whole)
    mirrored = isochore.Session(ball, mask={"mirror": [{"point": [0, 0, 0], "normal": np.array([0, 0, 1.0])}]}, lock=False)
    low = ball.positions[:, 2] < -0.9
    assert np.any(moved(mirrored, ball) & low) and not np.any(moved(isochore.Session(ball), ball) & low)
    # The log contains the mask, so its replay gives the same bits.
    log = {**session.log(), "refine": {"enabled": False}, "volume": {"lock": False}}
    unlocked, _ = session.export(lock=False)
    assert np.array_equal(isochore.run(log, meshes={"target": ball}).mesh.positions, unlocked.positions)


@pytest.mark.parametrize(
    "mask, error, words",
    [
        (np.zeros(3), ValueError, r"mask must have the shape \(2562\)"),
        (np.zeros((2562, 1)), ValueError, r"mask must have the shape \(2562\)"),
        (np.full(2562, np.nan), isochore.Error, "mask.vertices.0"),
        (np.full(2562, 2.0), isochore.Error, "mask.vertices.0"),
        ({"pin": []}, isochore.RecipeError, "pin"),
        ({"vertices": np.zeros(2562), "fade": -1}, isochore.Error, "fade"),
        ({"fade": float("nan")}, ValueError, "must be finite"),
        ({"fade": object()}, TypeError, "object"),
    ],
)
def test_rejects_invalid_masks(ball, mask, error, words):
    with pytest.raises(error, match=words):
        isochore.Session(ball, mask=mask)


def test_frozen_edges_and_kept_balls_are_not_refined(ball):
    def edited(**options):
        session = isochore.Session(ball)
        session.freeze_edges(options.pop("frozen", []))
        session.begin_stroke(
            isochore.Tool({"shape": {"kind": "sphere", "radius": 0.3}, "support": 0.4}), longest_edge=0.05, **options
        )
        session.move_to([0, 0, 1.5])
        session.move_to([0, 0, 1.1])
        receipt = session.end_stroke()
        return receipt["inserted_vertices"] + receipt["flipped_edges"] + receipt["removed_vertices"]

    assert edited() > 0
    assert edited(frozen=np.arange(len(ball.positions))) == 0
    assert edited(keep=[((0, 0, 1), 2.0)]) == 0
    session = isochore.Session(ball)
    with pytest.raises(ValueError, match="vertex 2562 is out of range"):
        session.freeze_edges([2562])
    with pytest.raises(ValueError, match="-1 is not a valid index"):
        session.freeze_edges([-1])
    with pytest.raises(ValueError, match="integers"):
        session.freeze_edges([0.5])
