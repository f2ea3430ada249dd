"""Libraries that find self-intersections or split long edges."""

import numpy as np
from peer import serve, timed

state = {}


def load(vertices, triangles):
    """Reads a mesh from two raw little-endian files: doubles and 32-bit integers, three per row."""
    state["vertices"] = np.fromfile(vertices, dtype="<f8").reshape(-1, 3)
    state["triangles"] = np.fromfile(triangles, dtype="<u4").reshape(-1, 3).astype(np.int64)
    state.pop("mesh_set", None)
    state.pop("manifold", None)
    return {}


def pymeshlab_intersections(output):
    """Finds the intersecting triangles and writes one byte per triangle to `output`."""
    import pymeshlab

    if "mesh_set" not in state:
        state["mesh_set"] = pymeshlab.MeshSet()
        state["mesh_set"].add_mesh(pymeshlab.Mesh(state["vertices"], state["triangles"].astype(np.int32)))
    mesh_set = state["mesh_set"]
    _, seconds = timed(mesh_set.compute_selection_by_self_intersections_per_face)
    mesh_set.current_mesh().face_selection_array().astype(np.uint8).tofile(output)
    return {"seconds": seconds}


def libigl_intersections(output):
    """As `pymeshlab_intersections`, but by libigl with exact arithmetic."""
    from igl.copyleft import cgal

    vertices, triangles = state["vertices"], state["triangles"]
    result, seconds = timed(lambda: cgal.remesh_self_intersections(vertices, triangles, detect_only=True))
    intersects = np.zeros(len(triangles), dtype=np.uint8)
    intersects[np.asarray(result[2]).ravel()] = 1
    intersects.tofile(output)
    return {"seconds": seconds}


def manifold_split(length):
    """Splits edges longer than `length`. Returns the size of the result and the change of the volume."""
    import manifold3d

    if "manifold" not in state:
        vertices, triangles = state["vertices"], state["triangles"].astype(np.uint64)
        state["manifold"] = manifold3d.Manifold(manifold3d.Mesh64(vert_properties=vertices, tri_verts=triangles))
    before = state["manifold"]

    def split():
        # The library evaluates lazily; the count forces the evaluation.
        after = before.refine_to_length(length)
        return after, after.num_tri()

    (after, count), seconds = timed(split)
    mesh = after.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts, dtype=np.int64)]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    return {
        "seconds": seconds,
        "triangles": count,
        "longest": longest,
        "volume_change": after.volume() / before.volume() - 1.0,
    }


serve(
    {
        "load": load,
        "pymeshlab_intersections": pymeshlab_intersections,
        "libigl_intersections": libigl_intersections,
        "manifold_split": manifold_split,
    }
)
