import json
import os
import queue
import signal
import threading

import numpy as np
import pytest

import isochore


@pytest.mark.parametrize("name", ["sphere", "bend"])
def test_same_bytes_as_the_command(name, recipes, command, tmp_path):
    path = recipes / f"{name}.toml"
    done = command("run", path, "--output", tmp_path / "out.obj", "--report", tmp_path / "report.json", "--quiet")
    assert done.returncode == 0, done.stderr
    result = isochore.run(path)
    assert result.mesh.to_bytes("obj") == (tmp_path / "out.obj").read_bytes()
    report = json.loads((tmp_path / "report.json").read_text())
    for key in ["before", "after", "volume_change", "volume_change_before_lock", "moved_vertices", "recipe_sha256"]:
        assert result.report[key] == report[key]


def test_a_dictionary_is_a_recipe(recipe):
    result = isochore.run(recipe, settings={"refine.volume": 1e-3})
    assert result.report["overrides"] == ["refine.volume=0.001"]
    assert abs(result.mesh.volume / result.rest.volume - 1) < 1e-12
    assert np.array_equal(result.mesh.triangles, result.rest.triangles)


def test_meshes_come_from_memory(recipe):
    target = isochore.run({**recipe, "stroke": []}).mesh
    from_memory = isochore.run({**recipe, "target": {"mesh": "clay.obj"}}, meshes={"clay.obj": target})
    assert from_memory.mesh.to_bytes("ply") == isochore.run(recipe).mesh.to_bytes("ply")


def test_points_move_like_vertices(recipe):
    bare = {"refine": {"enabled": False}, "volume": {"lock": False}}
    result = isochore.run({**recipe, **bare})
    points, warnings = isochore.run_points({**recipe, **bare}, result.rest.positions)
    assert np.array_equal(points, result.mesh.positions) and warnings == []


def test_errors_name_the_key_or_the_line(recipe, tmp_path):
    with pytest.raises(isochore.RecipeError) as caught:
        isochore.run({**recipe, "refine": {"volum": 1}})
    assert caught.value.key == "refine.volum" and "volume" in str(caught.value)
    (tmp_path / "bad.toml").write_text("recipe = 1\n[target]\nshape = 3\n")
    with pytest.raises(isochore.RecipeError) as caught:
        isochore.run(tmp_path / "bad.toml")
    assert caught.value.line == 3
    with pytest.raises(FileNotFoundError):
        isochore.run(tmp_path / "absent.toml")
    with pytest.raises(FileNotFoundError, match="clay.obj"):
        isochore.run({**recipe, "target": {"mesh": "clay.obj"}})
    with pytest.raises(ValueError, match="points: the number at 1"):
        isochore.run_points(recipe, [[0, np.inf, 0]])


def test_progress_reports_and_cancels(long_recipe):
    updates = []

    def progress(stage, done):
        updates.append((stage, done))
        return len(updates) < 3

    with pytest.raises(isochore.Cancelled):
        isochore.run(long_recipe, progress=progress)
    assert len(updates) == 3 and all(stage and 0 <= done <= 1 for stage, done in updates)

    def fail(stage, done):
        raise RuntimeError("on purpose")

    with pytest.raises(RuntimeError, match="on purpose"):
        isochore.run(long_recipe, progress=fail)


def test_ctrl_c_stops_the_work(long_recipe):
    # Shells start background processes without a handler.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    begun = queue.SimpleQueue()

    def interrupt():
        begun.get()
        os.kill(os.getpid(), signal.SIGINT)

    other = threading.Thread(target=interrupt)
    other.start()
    try:
        # `put` takes the stage and the fraction, and runs no bytecode that would raise the interrupt itself.
        with pytest.raises(KeyboardInterrupt):
            isochore.run(long_recipe, progress=begun.put)
    finally:
        signal.signal(signal.SIGINT, before)
    other.join()


def test_curves_and_weights_come_from_files(recipe, tmp_path):
    (tmp_path / "spine.csv").write_text("x,y,z\n-1.5,0,0\n0,0.1,0\n1.5,0,0\n")
    strip = {"kind": "strip", "mode": "along", "radius": 0.3, "support": 0.3, "distance": 0.2}
    with_points = {**recipe, "stroke": [{**strip, "spine": [[-1.5, 0, 0], [0, 0.1, 0], [1.5, 0, 0]]}]}
    (tmp_path / "recipe.json").write_text(json.dumps({**recipe, "stroke": [{**strip, "spine": "spine.csv"}]}))
    assert isochore.run(tmp_path / "recipe.json").mesh.to_bytes("ply") == isochore.run(with_points).mesh.to_bytes("ply")
    (tmp_path / "spine.csv").write_text("0,0,0\n1,2\n")
    with pytest.raises(isochore.Error, match="row 2 has 2 columns"):
        isochore.run(tmp_path / "recipe.json")
