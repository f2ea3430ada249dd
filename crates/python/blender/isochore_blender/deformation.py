"""The deformation of an object: read in Blender's thread, done in any, and written back in Blender's."""

import concurrent.futures
import threading

import numpy as np

import isochore

from .surface import Surface

TARGET = "the active mesh"
"""What the target is called while the recipe runs; no file of a recipe has this name."""


class Deformation:
    """What a recipe makes of the mesh of the object `target`.

    `recipe` is a path, or keys. Their lengths are those of the world. The object's own transform stays as it is.
    """

    def __init__(self, target, recipe):
        if target.data.shape_keys:
            raise ValueError("a mesh with shape keys cannot be refined: apply or remove them first")
        self.recipe, self.to_world = recipe, np.array(target.matrix_world)
        linear = self.to_world[:3, :3]
        if np.linalg.det(linear) == 0:
            raise ValueError("the object is scaled to nothing along some axis")
        self.surface = Surface(target, mirrored=np.linalg.det(linear) < 0)
        world = self.surface.positions @ linear.T + self.to_world[:3, 3]
        normals = self.surface.normals()
        if normals is not None:
            normals = normals @ np.linalg.inv(linear)
        self.sent = isochore.Mesh(world, self.surface.triangles, uvs=self.surface.uvs(), normals=normals)
        self.progress = "start", 0.0
        self._stopped = threading.Event()
        self._result = concurrent.futures.Future()

    def start(self):
        """Begins to work in a thread of its own."""
        threading.Thread(target=self.run, daemon=True).start()

    def run(self, show=lambda stage, done: None):
        """Works; `finish` gives what comes of it, or raises what went wrong. `show` is told of the stage and its share done."""

        def follow(stage, done):
            self.progress = stage, done
            show(stage, done)
            return not self._stopped.is_set()

        try:
            settings = {"target.mesh": TARGET}
            self._result.set_result(
                isochore.run(self.recipe, meshes={TARGET: self.sent}, settings=settings, progress=follow)
            )
        except BaseException as problem:
            self._result.set_exception(problem)

    def stop(self):
        """Asks the work to stop, so that `finish` raises `Cancelled`, unless it is over already."""
        self._stopped.set()

    def is_done(self):
        """Whether `finish` has not to wait."""
        return self._result.done()

    def finish(self):
        """Gives the object its new mesh: the report, and the names of attributes that were lost."""
        mesh, _, report = self._result.result()
        linear, world, surface = self.to_world[:3, :3], self.sent.positions, self.surface
        local = (mesh.positions - self.to_world[:3, 3]) @ np.linalg.inv(linear).T
        # What did not move keeps its bits, which the way to the world and back would not.
        still = np.all(mesh.positions[: len(world)] == world, axis=1)
        local[: len(world)][still] = surface.positions[still]
        is_same = np.array_equal(mesh.triangles, surface.triangles)
        lost = surface.move(local) if is_same else surface.replace(local, mesh.triangles, mesh.uvs)
        if mesh.normals is not None:
            surface.set_normals(mesh.normals @ linear)
        return report, lost
