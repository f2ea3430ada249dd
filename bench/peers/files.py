"""Reading and writing of mesh files by Python libraries.

The jobs are named `LIBRARY_read` and `LIBRARY_write` and receive the path. A write job writes the mesh
of the last read job.
"""

import importlib

from peer import serve, timed


class Meshlib:
    def start(self):
        self.library = importlib.import_module("meshlib.mrmeshpy")

    def read(self, path):
        self.mesh = self.library.loadMesh(path)
        return self.mesh.topology.numValidFaces()

    def write(self, path):
        self.library.saveMesh(self.mesh, path)


class Open3d:
    def start(self):
        self.library = importlib.import_module("open3d")

    def read(self, path):
        self.mesh = self.library.io.read_triangle_mesh(path)
        return len(self.mesh.triangles)

    def write(self, path):
        if not self.library.io.write_triangle_mesh(path, self.mesh, write_vertex_normals=False):
            raise OSError(f"Open3D cannot write {path}")


class Pymeshlab:
    def start(self):
        self.library = importlib.import_module("pymeshlab")

    def read(self, path):
        self.meshes = self.library.MeshSet()
        self.meshes.load_new_mesh(path)
        return self.meshes.current_mesh().face_number()

    def write(self, path):
        self.meshes.save_current_mesh(path, save_vertex_normal=False, save_wedge_texcoord=False)


class Trimesh:
    def start(self):
        self.library = importlib.import_module("trimesh")

    def read(self, path):
        # Skip processing, which welds and checks.
        self.mesh = self.library.load(path, process=False, force="mesh")
        return len(self.mesh.faces)

    def write(self, path):
        self.mesh.export(path)


LIBRARIES = {"meshlib": Meshlib(), "open3d": Open3d(), "pymeshlab": Pymeshlab(), "trimesh": Trimesh()}


def job(library, name):
    def work(path):
        if not hasattr(library, "library"):
            library.start()
        result, seconds = timed(lambda: getattr(library, name)(path))
        return {"seconds": seconds, "triangles": result or 0}

    return work


serve({f"{key}_{name}": job(library, name) for key, library in LIBRARIES.items() for name in ("read", "write")})
