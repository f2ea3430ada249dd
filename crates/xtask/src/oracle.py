"""Checks the meshes that the command writes: volume, area and closedness by PyMeshLab, self-intersection by libigl.

usage: oracle.py ISOCHORE RECIPES OUTPUT

Writes OUTPUT/rows.json, one row for each recipe.
"""

import json
import pathlib
import re
import subprocess
import sys

import igl.copyleft.cgal
import numpy
import pymeshlab

# PyMeshLab sums volumes in double precision about the origin, accurate to 1e-13 of the volume for meshes near it.
JUDGE_PRECISION = 1e-12
# It stores areas of triangles in single precision.
AREA_PRECISION = 1e-7
# Largest and mean change of volume before the lock, with refinement on.
BARE_LIMIT, BARE_MEAN = 1e-3, 3e-4


def judge(path):
    """Volume, area, closedness and number of self-intersecting triangles of a mesh file."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    mesh = meshes.current_mesh()
    topology = meshes.get_topological_measures()
    measures = meshes.get_geometric_measures()
    vertices, faces = mesh.vertex_matrix(), mesh.face_matrix().astype(numpy.int64)
    pairs = igl.copyleft.cgal.remesh_self_intersections(vertices, faces, detect_only=True)[2]
    return {
        "volume": measures["mesh_volume"],
        "area": measures["surface_area"],
        "closed": topology["boundary_edges"] == 0 and topology["is_mesh_two_manifold"],
        "self_intersecting_triangles": len(numpy.unique(pairs)),
    }


def run(isochore, recipe, output, settings, may_miss_promises=False):
    """Runs a recipe and returns the path of the mesh it wrote and its report."""
    mesh, report = output.with_suffix(".obj"), output.with_suffix(".json")
    command = [isochore, "run", recipe, "--output", mesh, "--report", report, "--quiet"]
    for setting in settings:
        command += ["--set", setting]
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if result.returncode != 0 and not (may_miss_promises and result.returncode == 1):
        raise SystemExit(f"{recipe} with {settings}: exit code {result.returncode}: {result.stderr.strip()}")
    return mesh, json.loads(report.read_text())


def expect(condition, message):
    if not condition:
        raise SystemExit(f"oracle: {message}")


def compare(name, judged, reported):
    """Compares the figures of the report with those of the independent libraries."""
    expect(judged["closed"] == reported["closed"], f"{name}: closed is {judged['closed']}, reported {reported['closed']}")
    for key, precision in (("volume", JUDGE_PRECISION), ("area", AREA_PRECISION)):
        off = abs(judged[key] / reported[key] - 1)
        expect(off < precision, f"{name}: {key} is {judged[key]!r}, reported {reported[key]!r}")
    key = "self_intersecting_triangles"
    expect(judged[key] == reported[key], f"{name}: {key} {judged[key]}, reported {reported[key]}")


def judge_recipe(isochore, recipe, output):
    """Runs a recipe with and without the lock, checks all three meshes, and returns the row of the table."""
    name = recipe.stem
    bare_mesh, bare_report = run(isochore, recipe, output / f"{name}-bare", ["volume.lock=false"], may_miss_promises=True)
    locked_mesh, locked_report = run(isochore, recipe, output / f"{name}-locked", ["volume.lock=true"])
    rest_mesh, _ = run(isochore, recipe, output / f"{name}-rest", ["stroke=[]", "volume.lock=false"])
    rest, bare, locked = judge(rest_mesh), judge(bare_mesh), judge(locked_mesh)
    compare(f"{name} at rest", rest, bare_report["before"])
    compare(f"{name} bare", bare, bare_report["after"])
    compare(f"{name} locked", locked, locked_report["after"])
    bare_change = bare["volume"] / rest["volume"] - 1
    locked_change = locked["volume"] / rest["volume"] - 1
    expect(abs(bare_change) <= BARE_LIMIT, f"{name}: without the lock, the volume changes by {bare_change:.1e}")
    expect(abs(locked_change) <= JUDGE_PRECISION, f"{name}: with the lock, the volume changes by {locked_change:.1e}")
    print(
        f"{name:<24} {bare_report['before']['triangles']:>8} -> {bare_report['after']['triangles']:>8} triangles"
        f"   bare {bare_change:+.1e}   locked {locked_change:+.1e}"
        f"   crossing {rest['self_intersecting_triangles']} -> {locked['self_intersecting_triangles']}",
        flush=True,
    )
    return {
        "recipe": title(recipe),
        "triangles": bare_report["before"]["triangles"],
        "refined": bare_report["after"]["triangles"],
        "bare": bare_change,
        "locked": locked_change,
        "crossing": locked["self_intersecting_triangles"],
    }


def title(recipe):
    """The first clause of the comment that a recipe begins with."""
    return re.split(r"[.:;]", recipe.read_text().splitlines()[0].removeprefix("# "))[0]


# The closed scan that PyMeshLab ships, used where it is installed and never copied; 0.62 units long.
BUNNY = pathlib.Path(pymeshlab.__file__).parent / "tests/sample_meshes/bunny.obj"
BUNNY_RECIPES = {
    "bunny-press": """# A ball is pressed into the bunny.
tools.tool = { shape = { kind = "sphere", radius = 0.1 }, support = 0.08 }
[[stroke]]
kind = "move"
tool = "tool"
keys = [ { at = [0.3, 0.2, 0.75] }, { at = [0.3, 0.2, 0.55] } ]
""",
    "bunny-rod": """# A rod turns by 90° in the bunny.
tools.tool = { shape = { kind = "capsule", radius = 0.04, half_length = 0.2 }, support = 0.08 }
integrate.step = 0.05
[[stroke]]
kind = "move"
tool = "tool"
keys = [ { at = [0.35, 0.1, 0.52] }, { at = [0.35, 0.1, 0.52], rotate = [0, 1, 0, 90] } ]
""",
    "bunny-twist": """# The bunny is twisted by 180°.
[[stroke]]
kind = "twist"
origin = [0.3, 0.2, 0.3]
axis = [0, 1, 0]
degrees_per_unit = 290
""",
    "bunny-bend": """# The bunny is swirled.
[[stroke]]
kind = "bend"
origin = [0.3, 0.2, 0.3]
axis = [0, 0, 1]
degrees_per_unit2 = 400
""",
}


def bunny_recipes(output):
    """Writes the recipes for the scan and returns their paths."""
    paths = []
    for name, strokes in BUNNY_RECIPES.items():
        path = output / f"{name}.toml"
        comment, strokes = strokes.split("\n", 1)
        # Keys before the first table belong to the recipe itself.
        path.write_text(f"{comment}\nrecipe = 1\ntarget.mesh = {json.dumps(str(BUNNY))}\n{strokes}")
        paths.append(path)
    return paths


def main():
    isochore, recipes, output = (pathlib.Path(argument) for argument in sys.argv[1:])
    paths = sorted(recipes.glob("*.toml")) + bunny_recipes(output)
    rows = [judge_recipe(isochore, path, output) for path in paths]
    (output / "rows.json").write_text(json.dumps(rows))
    mean = sum(abs(row["bare"]) for row in rows) / len(rows)
    expect(mean <= BARE_MEAN, f"without the lock, the mean change of volume is {mean:.1e}")
    print(f"{len(rows)} passed, 0 failed; mean change of volume without the lock: {mean:.1e}")


if __name__ == "__main__":
    main()
