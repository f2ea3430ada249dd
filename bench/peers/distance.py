"""Signed distances by one library: `distance.py LIBRARY`.

Arrays are passed through files: vertices and points in double precision, triangles as 32-bit indices.
The points are layers of a grid; x varies fastest.
"""

import importlib
import sys

import numpy

from peer import serve, timed


def read(path, kind):
    return numpy.fromfile(path, kind).reshape(-1, 3)


class Open3d:
    def start(self):
        self.library = importlib.import_module("open3d")

    def prepare(self, vertices, triangles):
        self.vertices, self.triangles = vertices.astype(numpy.float32), triangles.astype(numpy.uint32)

    def build(self):
        self.scene = self.library.t.geometry.RaycastingScene(nthreads=1)
        self.scene.add_triangles(self.vertices, self.triangles)
        # The first query builds the hierarchy.
        self.scene.compute_distance(self.vertices[:1])

    def prepare_points(self, points, grid):
        self.points = points.astype(numpy.float32)

    def query(self):
        return self.scene.compute_signed_distance(self.points, nthreads=1).numpy()


class Libigl:
    def start(self):
        self.library = importlib.import_module("igl")

    def prepare(self, vertices, triangles):
        self.vertices, self.triangles = vertices, triangles.astype(numpy.int64)

    # The library has one function for all steps. Its time for a single point is that of the preparation.
    builds_in_query = True

    def build(self):
        self.signed_distance(self.vertices[:1])

    def prepare_points(self, points, grid):
        self.points = points

    def query(self):
        return self.signed_distance(self.points)

    def signed_distance(self, points):
        kind = self.library.SignedDistanceType.SIGNED_DISTANCE_TYPE_PSEUDONORMAL
        return self.library.signed_distance(points, self.vertices, self.triangles, kind)[0]


class Meshlib:
    def start(self):
        self.library = importlib.import_module("meshlib.mrmeshpy")
        self.numpy = importlib.import_module("meshlib.mrmeshnumpy")

    def prepare(self, vertices, triangles):
        self.arrays = triangles, vertices

    def build(self):
        self.mesh = self.numpy.meshFromFacesVerts(*self.arrays)
        self.mesh.getAABBTree()

    def prepare_points(self, points, grid):
        vector = self.library.Vector3f
        self.parameters = self.library.MeshToDistanceVolumeParams()
        volume = self.parameters.vol
        # The samples are at the centers of the cells.
        volume.origin = vector(*(grid["first"][axis] - 0.5 * grid["step"][axis] for axis in range(3)))
        volume.voxelSize = vector(*grid["step"])
        volume.dimensions = self.library.Vector3i(*grid["dims"])
        self.parameters.dist.signMode = self.library.SignDetectionMode.ProjectionNormal

    def query(self):
        volume = self.library.meshToDistanceVolume(self.library.MeshPart(self.mesh), self.parameters)
        # Reorder from [x, y, z].
        return self.numpy.getNumpy3Darray(volume).transpose(2, 1, 0).ravel()


class Warp:
    def start(self):
        self.library = wp = importlib.import_module("warp")
        wp.config.quiet = True
        wp.init()

        @wp.kernel
        def signed_distance(mesh: wp.uint64, points: wp.array(dtype=wp.vec3), distances: wp.array(dtype=wp.float32)):
            i = wp.tid()
            result = wp.mesh_query_point_sign_normal(mesh, points[i], 1.0e6)
            nearest = wp.mesh_eval_position(mesh, result.face, result.u, result.v)
            distances[i] = result.sign * wp.length(points[i] - nearest)

        self.kernel = signed_distance

    def array(self, numbers, kind):
        return self.library.array(numbers, dtype=kind, device="cpu")

    def prepare(self, vertices, triangles):
        self.vertices = self.array(vertices.astype(numpy.float32), self.library.vec3)
        self.triangles = self.array(triangles.astype(numpy.int32).ravel(), self.library.int32)

    def build(self):
        self.mesh = self.library.Mesh(points=self.vertices, indices=self.triangles)

    def prepare_points(self, points, grid):
        self.points = self.array(points.astype(numpy.float32), self.library.vec3)
        self.distances = self.library.zeros(len(points), dtype=self.library.float32, device="cpu")
        # Compile the kernel.
        self.library.launch(self.kernel, 1, inputs=[self.mesh.id, self.points, self.distances], device="cpu")

    def query(self):
        inputs = [self.mesh.id, self.points, self.distances]
        self.library.launch(self.kernel, len(self.points), inputs=inputs, device="cpu")
        return self.distances.numpy()


class Fcpw:
    """This library computes unsigned distances."""

    def start(self):
        self.library = importlib.import_module("fcpw")

    def prepare(self, vertices, triangles):
        self.vertices, self.triangles = vertices.astype(numpy.float32), triangles.astype(numpy.int32)

    def build(self):
        self.scene = self.library.scene_3D()
        self.scene.set_object_count(1)
        self.scene.set_object_vertices(self.vertices, 0)
        self.scene.set_object_triangles(self.triangles, 0)
        self.scene.build(self.library.aggregate_type.bvh_surface_area, True)

    def prepare_points(self, points, grid):
        self.points = numpy.asfortranarray(points, numpy.float32)
        self.reaches = numpy.full(len(points), numpy.inf, numpy.float32)

    def query(self):
        found = self.library.interaction_3D_list()
        self.scene.find_closest_points(self.points, self.reaches, found)
        return found

    def unpack(self, found):
        return [each.d for each in found]


class Pysdf:
    def start(self):
        self.library = importlib.import_module("pysdf")

    def prepare(self, vertices, triangles):
        self.vertices, self.triangles = vertices.astype(numpy.float32), triangles.astype(numpy.uint32)

    def build(self):
        self.sdf = self.library.SDF(self.vertices, self.triangles)

    def prepare_points(self, points, grid):
        self.points = points.astype(numpy.float32)

    def query(self):
        return -self.sdf(self.points, n_threads=1)


LIBRARIES = {
    "open3d": Open3d,
    "libigl": Libigl,
    "meshlib": Meshlib,
    "warp": Warp,
    "fcpw": Fcpw,
    "pysdf": Pysdf,
}

peer = LIBRARIES[sys.argv[1]]()


def start():
    peer.start()
    return {}


def prepare(vertices, triangles):
    peer.prepare(read(vertices, numpy.float64), read(triangles, numpy.uint32))
    return {}


def build():
    peer.built = timed(peer.build)[1]
    return {"seconds": peer.built}


def prepare_points(points, grid):
    peer.prepare_points(read(points, numpy.float64), grid)
    return {}


def query(distances):
    results, seconds = timed(peer.query)
    if hasattr(peer, "unpack"):
        results = peer.unpack(results)
    numpy.asarray(results, numpy.float64).tofile(distances)
    return {"seconds": seconds - peer.built if hasattr(peer, "builds_in_query") else seconds}


serve({"start": start, "prepare": prepare, "build": build, "prepare_points": prepare_points, "query": query})
