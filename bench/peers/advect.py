"""Advection in a sampled velocity with trilinear interpolation, by one library: `advect.py LIBRARY`.

The code is compiled and uses single precision. One call advects all points through all steps.
Arrays are passed through files.
"""

import importlib
import sys

import numpy

from peer import serve, timed

SINGLE = numpy.float32


class Warp:
    def start(self):
        self.library = wp = importlib.import_module("warp")
        wp.config.quiet = True
        wp.init()
        wp.set_module_options({"enable_backward": False, "fast_math": True})

        @wp.func
        def velocity(grid: wp.array(dtype=wp.vec3), nodes: int, point: wp.vec3):
            # All points are inside the grid, so no clamping is needed.
            i, j, k = int(point[0]), int(point[1]), int(point[2])
            u, v, w = point[0] - float(i), point[1] - float(j), point[2] - float(k)
            first = (k * nodes + j) * nodes + i
            layer = first + nodes * nodes
            low_front = wp.lerp(grid[first], grid[first + 1], u)
            low_back = wp.lerp(grid[first + nodes], grid[first + nodes + 1], u)
            high_front = wp.lerp(grid[layer], grid[layer + 1], u)
            high_back = wp.lerp(grid[layer + nodes], grid[layer + nodes + 1], u)
            return wp.lerp(wp.lerp(low_front, low_back, v), wp.lerp(high_front, high_back, v), w)

        @wp.kernel
        def advect(
            grid: wp.array(dtype=wp.vec3),
            nodes: int,
            steps: int,
            points: wp.array(dtype=wp.vec3),
            ends: wp.array(dtype=wp.vec3),
        ):
            index = wp.tid()
            point = points[index]
            for _ in range(steps):
                k1 = velocity(grid, nodes, point)
                k2 = velocity(grid, nodes, point + 0.5 * k1)
                k3 = velocity(grid, nodes, point + 0.5 * k2)
                k4 = velocity(grid, nodes, point + k3)
                point += (k1 + 2.0 * (k2 + k3) + k4) / 6.0
            ends[index] = point

        self.kernel = advect

    def prepare(self, grid, nodes, points, steps):
        def array(numbers):
            return self.library.array(numbers, dtype=self.library.vec3, device="cpu")

        self.ends = array(points)
        self.inputs = [array(grid), nodes, steps, array(points), self.ends]
        self.count = len(points)

    def advect(self):
        self.library.launch(self.kernel, self.count, inputs=self.inputs, device="cpu")
        return self.ends.numpy()


class Numba:
    def start(self):
        numba = importlib.import_module("numba")
        compiled = numba.njit(fastmath=True, error_model="numpy", inline="always")
        half, two, sixth = SINGLE(0.5), SINGLE(2.0), SINGLE(1.0 / 6.0)

        @compiled
        def velocity(grid, nodes, x, y, z):
            # All points are inside the grid, so no clamping is needed. Unsigned indices avoid the check
            # for negative ones.
            i, j, k = numba.uint32(x), numba.uint32(y), numba.uint32(z)
            u, v, w = x - SINGLE(i), y - SINGLE(j), z - SINGLE(k)
            first = numba.uintp((k * nodes + j) * nodes + i)
            back, layer = numba.uintp(nodes), numba.uintp(nodes * nodes)

            def lerp(a, b, t):
                return a + t * (b - a)

            def along(start, axis):
                return lerp(grid[start, axis], grid[start + numba.uintp(1), axis], u)

            def over(axis):
                low = lerp(along(first, axis), along(first + back, axis), v)
                high = lerp(along(first + layer, axis), along(first + layer + back, axis), v)
                return lerp(low, high, w)

            return over(numba.uintp(0)), over(numba.uintp(1)), over(numba.uintp(2))

        @numba.njit(parallel=True, fastmath=True, error_model="numpy")
        def advect(grid, nodes, steps, points, ends):
            nodes = numba.uint32(nodes)
            for index in numba.prange(len(points)):
                x, y, z = points[index, 0], points[index, 1], points[index, 2]
                for _ in range(steps):
                    a1, b1, c1 = velocity(grid, nodes, x, y, z)
                    a2, b2, c2 = velocity(grid, nodes, x + half * a1, y + half * b1, z + half * c1)
                    a3, b3, c3 = velocity(grid, nodes, x + half * a2, y + half * b2, z + half * c2)
                    a4, b4, c4 = velocity(grid, nodes, x + a3, y + b3, z + c3)
                    x += sixth * (a1 + two * (a2 + a3) + a4)
                    y += sixth * (b1 + two * (b2 + b3) + b4)
                    z += sixth * (c1 + two * (c2 + c3) + c4)
                ends[index, 0], ends[index, 1], ends[index, 2] = x, y, z

        self.function = advect

    def prepare(self, grid, nodes, points, steps):
        self.ends = numpy.empty_like(points)
        self.arguments = grid, nodes, steps, points, self.ends

    def advect(self):
        self.function(*self.arguments)
        return self.ends


LIBRARIES = {"warp": Warp, "numba": Numba}

peer = LIBRARIES[sys.argv[1]]()


def start():
    peer.start()
    return {}


def prepare(grid, nodes, points, steps):
    """Receives the input and compiles the code.

    `grid`: displacement per step in cells, [z, y, x, 3]. `points`: in cells from the first node.
    """

    def read(path):
        return numpy.fromfile(path, numpy.float64).reshape(-1, 3).astype(SINGLE)

    peer.prepare(read(grid), nodes, read(points), steps)
    peer.advect()
    return {}


def advect(ends):
    """Advects the points and writes their end positions, in cells."""
    positions, seconds = timed(peer.advect)
    positions.astype(numpy.float64).tofile(ends)
    return {"seconds": seconds}


serve({"start": start, "prepare": prepare, "advect": advect})
