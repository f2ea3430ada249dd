"""Presses a torus into a box from trimesh and prints the change of its volume."""

import sys

import trimesh

import isochore

clay = trimesh.creation.box(extents=[2, 2, 1]).subdivide_to_size(0.1)
ring = trimesh.creation.torus(major_radius=0.5, minor_radius=0.12)

pressed, _, report = isochore.run(
    {
        "recipe": 1,
        "target": {"mesh": "clay"},
        "tools": {"ring": {"shape": {"kind": "mesh", "mesh": "ring", "resolution": 48}, "support": 0.15}},
        "stroke": [{"kind": "move", "tool": "ring", "keys": [{"at": [0, 0, 0.8]}, {"at": [0, 0, 0.5]}]}],
    },
    meshes={"clay": clay, "ring": ring},
)

print(f"{len(clay.faces)} triangles became {len(pressed.triangles)}")
print(f"volume before {clay.volume:.6f}, after {pressed.to_trimesh().volume:.6f}")
print(f"bare change {report['volume_change_before_lock']:+.1e}, after the lock {report['volume_change']:+.1e}")
if len(sys.argv) > 1:
    pressed.write(sys.argv[1])
