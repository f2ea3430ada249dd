import json
import os
import signal

import pytest
from distributed import Client, LocalCluster

import isochore
from isochore import farm


@pytest.fixture(scope="module")
def client():
    cluster = LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, memory_limit=None
    )
    with cluster, Client(cluster) as client:
        yield client


@pytest.fixture
def job(recipe, tmp_path):
    """A recipe file and twelve targets."""
    del recipe["target"]["shape"]
    recipe["target"]["mesh"] = "none.ply"
    (tmp_path / "press.json").write_text(json.dumps(recipe))
    targets = []
    for index in range(12):
        shape = {"kind": "icosphere", "radius": 1.0 + 0.02 * index, "subdivisions": 5}
        ball = isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh
        targets.append(tmp_path / "targets" / f"ball_{index:02}.ply")
        targets[-1].parent.mkdir(exist_ok=True)
        ball.write(targets[-1])
    return tmp_path / "press.json", targets


def test_a_killed_worker_costs_nothing(client, job, tmp_path):
    recipe, targets = job
    results = tmp_path / "results"
    outcomes = farm.run(recipe, targets, results, client=client)
    first = next(outcomes)
    before = {path: path.stat().st_mtime_ns for path in results.glob("*.ply.json")}
    assert before
    victim = next(iter(client.run(os.getpid).values()))
    os.kill(victim, signal.SIGKILL)
    outcomes = dict([first, *outcomes])

    assert sorted(outcomes) == targets
    for target, report in outcomes.items():
        assert isinstance(report, dict), f"{target}: {report}"
        alone = isochore.run(recipe, settings=[f"target.mesh={json.dumps(str(target))}"])
        assert (results / target.name).read_bytes() == alone.mesh.to_bytes("ply")
        assert report["after"] == alone.report["after"]
    # What was there before the worker died was not made again.
    assert before == {path: path.stat().st_mtime_ns for path in before}
    assert not list(results.glob(".isochore-*"))

    times = {path: path.stat().st_mtime_ns for path in results.iterdir()}
    assert len(times) == 2 * len(targets)
    again = dict(farm.run(recipe, targets, results, client=client))
    assert again == outcomes
    assert times == {path: path.stat().st_mtime_ns for path in results.iterdir()}


def test_what_has_changed_is_done_again(client, job, tmp_path):
    recipe, targets = job
    results = tmp_path / "results"
    [(_, first)] = farm.run(recipe, targets[:1], results, client=client)
    [(_, second)] = farm.run(recipe, targets[:1], results, client=client, settings=["refine.enabled=false"])
    assert first["inserted_vertices"] > 0 and second["inserted_vertices"] == 0


def test_a_changed_tool_makes_a_new_result(client, job, tmp_path):
    recipe, targets = job
    table = json.loads(recipe.read_text())
    [name] = table["tools"]
    table["tools"][name]["shape"] = {"kind": "mesh", "mesh": "tool.ply", "resolution": 16}
    recipe.write_text(json.dumps(table))
    places = []
    for radius in [0.3, 0.35]:
        shape = {"kind": "icosphere", "radius": radius, "subdivisions": 3}
        isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh.write(tmp_path / "tool.ply")
        [(_, report)] = farm.run(recipe, targets[:1], tmp_path / "results", client=client)
        assert isinstance(report, dict)
        places.append((tmp_path / "results" / targets[0].name).read_bytes())
        alone = isochore.run(recipe, settings=[f"target.mesh={json.dumps(str(targets[0]))}"])
        assert places[-1] == alone.mesh.to_bytes("ply")
    assert places[0] != places[1]


def test_a_report_tells_of_the_mesh_beside_it(client, job, tmp_path):
    recipe, targets = job
    results = tmp_path / "results"
    place = results / targets[0].name
    [(_, first)] = farm.run(recipe, targets[:1], results, client=client)
    mesh = place.read_bytes()
    # As a worker leaves it that dies between mesh and report.
    isochore.Mesh.read(targets[1]).write(place)
    [(_, second)] = farm.run(recipe, targets[:1], results, client=client)
    assert place.read_bytes() == mesh and second["after"] == first["after"]


def test_one_bad_target_spoils_no_other(client, job, tmp_path):
    recipe, targets = job
    targets[0].write_text("no mesh")
    outcomes = dict(farm.run(recipe, targets[:3], tmp_path / "results", client=client))
    assert isinstance(outcomes[targets[0]], isochore.Error)
    assert isinstance(outcomes[targets[1]], dict) and isinstance(outcomes[targets[2]], dict)


def test_results_cannot_overwrite_their_sources(client, job):
    recipe, targets = job
    with pytest.raises(ValueError, match="take the place"):
        list(farm.run(recipe, targets, targets[0].parent, client=client))
    with pytest.raises(ValueError, match="same name"):
        list(farm.run(recipe, [*targets, targets[0].with_suffix(".obj")], "elsewhere", client=client))
