"""Deformation of an object.

Blender's thread reads the object and writes the result back. Any thread can run the deformation.
"""

import concurrent.futures
import threading

import numpy as np

import isochore

from .surface import Surface

TARGET = "the active mesh"
"""Name of the target mesh while the recipe runs. No file has this name."""


class Deformation:
    """Deforms the mesh of the object `target` by a recipe.

    `recipe` is a path or a mapping. Its lengths are in world space. The transform of the object
    does not change.
    """

    def __init__(self, target, recipe):
        if target.data.shape_keys:
            raise ValueError("a mesh with shape keys cannot be refined: apply or remove the shape keys first")
        self.recipe, self.to_world = recipe, np.array(target.matrix_world)
        linear = self.to_world[:3, :3]
        if np.linalg.det(linear) == 0:
            raise ValueError("the scale of the object is zero along an axis")
        self.surface = Surface(target, mirrored=np.linalg.det(linear) < 0)
        world = self.surface.positions @ linear.T + self.to_world[:3, 3]
        normals = self.surface.normals()
        if normals is not None:
            normals = normals @ np.linalg.inv(linear)
        self.sent_mesh = isochore.Mesh(world, self.surface.triangles, uvs=self.surface.uvs(), normals=normals)
        self.progress = "start", 0.0
        self._stopped = threading.Event()
        self._result = concurrent.futures.Future()

    def start(self):
        """Runs the deformation in a new thread."""
        threading.Thread(target=self.run, daemon=True).start()

    def run(self, show=lambda stage, done: None):
        """Runs the deformation, whose result `finish` returns. Calls `show(stage, fraction)`."""

        def follow(stage, done):
            self.progress = stage, done
            show(stage, done)
            return not self._stopped.is_set()

        try:
            settings = {"target.mesh": TARGET}
            self._result.set_result(
                isochore.run(self.recipe, meshes={TARGET: self.sent_mesh}, settings=settings, progress=follow)
            )
        except BaseException as error:
            self._result.set_exception(error)

    def stop(self):
        """Cancels the deformation if it has not finished. `finish` then raises `Cancelled`."""
        self._stopped.set()

    def is_done(self):
        """Whether the deformation has finished, so that `finish` does not wait."""
        return self._result.done()

    def finish(self):
        """Writes the result to the object. Returns the report and the names of lost attributes."""
        mesh, _, report = self._result.result()
        linear, world, surface = self.to_world[:3, :3], self.sent_mesh.positions, self.surface
        local = (mesh.positions - self.to_world[:3, 3]) @ np.linalg.inv(linear).T
        # Vertices that did not move keep their exact positions, which a round trip through world space would change.
        unmoved = np.all(mesh.positions[: len(world)] == world, axis=1)
        local[: len(world)][unmoved] = surface.positions[unmoved]
        is_same = np.array_equal(mesh.triangles, surface.triangles)
        lost = surface.move(local) if is_same else surface.replace(local, mesh.triangles, mesh.uvs)
        if mesh.normals is not None:
            surface.set_normals(mesh.normals @ linear)
        return report, lost
