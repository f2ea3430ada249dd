import json
import os
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


def test_plain_data_is_a_recipe(recipe):
    result = isochore.run(recipe, settings={"refine.volume": 1e-3})
    assert result.report["overrides"] == ["refine.volume=0.001"]
    assert abs(result.mesh.volume / result.rest.volume - 1) < 1e-12
    assert np.array_equal(result.mesh.triangles, result.rest.triangles)


def test_meshes_come_from_memory(recipe):
    target = isochore.run({**recipe, "stroke": []}).mesh
    from_memory = isochore.run({**recipe, "target": {"mesh": "clay.obj"}}, meshes={"clay.obj": target})
    assert from_memory.mesh.to_bytes("ply") == isochore.run(recipe).mesh.to_bytes("ply")


def test_points_go_where_vertices_go(recipe):
    bare = {"refine": {"enabled": False}, "volume": {"lock": False}}
    result = isochore.run({**recipe, **bare})
    points, warnings = isochore.run_points({**recipe, **bare}, result.rest.positions)
    assert np.array_equal(points, result.mesh.positions) and warnings == []


def test_what_is_wrong_is_named(recipe, tmp_path):
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


def long_work(recipe):
    """Takes minutes."""
    target = {"shape": {"kind": "icosphere", "radius": 1.0, "subdivisions": 8}}
    return {**recipe, "target": target, "integrate": {"step": 1e-4}}


def test_progress_is_told_and_can_stop(recipe):
    heard = []

    def progress(stage, done):
        heard.append((stage, done))
        return len(heard) < 3

    with pytest.raises(isochore.Cancelled):
        isochore.run(long_work(recipe), progress=progress)
    assert len(heard) == 3 and all(stage and 0 <= done <= 1 for stage, done in heard)

    def stumble(stage, done):
        raise RuntimeError("on purpose")

    with pytest.raises(RuntimeError, match="on purpose"):
        isochore.run(long_work(recipe), progress=stumble)


def test_ctrl_c_stops(recipe):
    # Shells start what runs in the background without a handler.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            isochore.run(long_work(recipe))
    finally:
        signal.signal(signal.SIGINT, before)


def test_other_threads_run_meanwhile(recipe):
    counts = []
    stop = threading.Event()

    def count():
        while not stop.wait(0.001):
            counts.append(1)

    other = threading.Thread(target=count)
    other.start()
    isochore.run(recipe, settings=["integrate.step=0.001"])
    stop.set()
    other.join()
    assert len(counts) > 10


def test_curves_and_weights_come_from_files(recipe, tmp_path):
    (tmp_path / "spine.csv").write_text("x,y,z\n-1.5,0,0\n0,0.1,0\n1.5,0,0\n")
    strip = {"kind": "strip", "mode": "along", "radius": 0.3, "support": 0.3, "distance": 0.2}
    with_points = {**recipe, "stroke": [{**strip, "spine": [[-1.5, 0, 0], [0, 0.1, 0], [1.5, 0, 0]]}]}
    (tmp_path / "recipe.json").write_text(json.dumps({**recipe, "stroke": [{**strip, "spine": "spine.csv"}]}))
    assert isochore.run(tmp_path / "recipe.json").mesh.to_bytes("ply") == isochore.run(with_points).mesh.to_bytes("ply")
    (tmp_path / "spine.csv").write_text("0,0,0\n1,2\n")
    with pytest.raises(isochore.Error, match="row 2 has 2 columns"):
        isochore.run(tmp_path / "recipe.json")
