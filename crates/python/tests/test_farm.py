import json
import os
import signal
import struct

import numpy as np
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


def test_a_killed_worker_loses_no_results(client, job, tmp_path):
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
    # Results written before the worker died were not computed again.
    assert before == {path: path.stat().st_mtime_ns for path in before}
    assert not list(results.glob(".isochore-*"))

    times = {path: path.stat().st_mtime_ns for path in results.iterdir()}
    assert len(times) == 2 * len(targets)
    again = dict(farm.run(recipe, targets, results, client=client))
    assert again == outcomes
    assert times == {path: path.stat().st_mtime_ns for path in results.iterdir()}


def test_changed_settings_are_computed_again(client, job, tmp_path):
    recipe, targets = job
    results = tmp_path / "results"
    [(_, first)] = farm.run(recipe, targets[:1], results, client=client)
    [(_, second)] = farm.run(recipe, targets[:1], results, client=client, settings={"refine.enabled": False})
    assert first["inserted_vertices"] > 0 and second["inserted_vertices"] == 0


def test_a_changed_tool_mesh_is_computed_again(client, job, tmp_path):
    recipe, targets = job
    table = json.loads(recipe.read_text())
    [name] = table["tools"]
    table["tools"][name]["shape"] = {"kind": "mesh", "mesh": "tool.ply", "resolution": 16}
    recipe.write_text(json.dumps(table))
    outputs = []
    for radius in [0.3, 0.35]:
        shape = {"kind": "icosphere", "radius": radius, "subdivisions": 3}
        isochore.run({"recipe": 1, "target": {"shape": shape}, "stroke": []}).mesh.write(tmp_path / "tool.ply")
        [(_, report)] = farm.run(recipe, targets[:1], tmp_path / "results", client=client)
        assert isinstance(report, dict)
        outputs.append((tmp_path / "results" / targets[0].name).read_bytes())
        alone = isochore.run(recipe, settings=[f"target.mesh={json.dumps(str(targets[0]))}"])
        assert outputs[-1] == alone.mesh.to_bytes("ply")
    assert outputs[0] != outputs[1]


@pytest.mark.parametrize("format", ["gltf", "glb"])
def test_files_named_by_a_document_are_inputs(client, job, tmp_path, format):
    recipe, targets = job
    document, binary = split(isochore.Mesh.read(targets[0]).to_bytes("glb"))
    (tmp_path / "parts").mkdir()
    document["buffers"][0]["uri"] = "parts/a%20buffer.bin"
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    if format == "glb":
        text = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text), len(text), b"JSON") + text
    target = tmp_path / f"ball.{format}"
    target.write_bytes(text)
    reports = []
    for size in [1.0, 1.5]:
        # The positions are at the beginning of the buffer.
        count = document["accessors"][0]["count"]
        assert document["accessors"][0]["type"] == "VEC3" and document["bufferViews"][0].get("byteOffset", 0) == 0
        scaled = (np.frombuffer(binary, "<f4", 3 * count) * np.float32(size)).tobytes()
        (tmp_path / "parts" / "a buffer.bin").write_bytes(scaled + binary[12 * count :])
        for _ in range(2):
            [(_, report)] = farm.run(recipe, [target], tmp_path / "results", client=client)
            assert isinstance(report, dict), report
            reports.append(report)
    assert reports[0] == reports[1] and reports[2] == reports[3]
    assert reports[2]["before"]["volume"] == pytest.approx(1.5**3 * reports[0]["before"]["volume"], rel=1e-6)


def split(glb):
    """Returns the document of a GLB file and its binary part."""
    length = struct.unpack_from("<I", glb, 12)[0]
    return json.loads(glb[20 : 20 + length]), glb[28 + length :]


def test_results_have_the_permissions_of_new_files(client, job, tmp_path):
    recipe, targets = job
    fresh = tmp_path / "fresh"
    fresh.touch()
    list(farm.run(recipe, targets[:1], tmp_path / "results", client=client))
    assert [path.stat().st_mode for path in (tmp_path / "results").iterdir()] == 2 * [fresh.stat().st_mode]


def test_a_mesh_without_its_report_is_computed_again(client, job, tmp_path):
    recipe, targets = job
    results = tmp_path / "results"
    output = results / targets[0].name
    [(_, first)] = farm.run(recipe, targets[:1], results, client=client)
    mesh = output.read_bytes()
    # The state after a worker died between writing the mesh and writing the report.
    isochore.Mesh.read(targets[1]).write(output)
    [(_, second)] = farm.run(recipe, targets[:1], results, client=client)
    assert output.read_bytes() == mesh and second["after"] == first["after"]


def test_a_bad_target_does_not_affect_others(client, job, tmp_path):
    recipe, targets = job
    targets[0].write_text("not a mesh")
    outcomes = dict(farm.run(recipe, targets[:3], tmp_path / "results", client=client))
    assert isinstance(outcomes[targets[0]], isochore.Error)
    assert isinstance(outcomes[targets[1]], dict) and isinstance(outcomes[targets[2]], dict)


def test_results_cannot_overwrite_their_sources(client, job):
    recipe, targets = job
    with pytest.raises(ValueError, match="would overwrite"):
        list(farm.run(recipe, targets, targets[0].parent, client=client))
    with pytest.raises(ValueError, match="same name"):
        list(farm.run(recipe, [*targets, targets[0].with_suffix(".obj")], "elsewhere", client=client))
