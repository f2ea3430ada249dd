"""The triangles of an object, and interpolation of its attributes on the refined triangles."""

import numpy as np

FIELDS = {
    "FLOAT": ("value", 1, np.float32),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int8),
    "BOOLEAN": ("value", 1, bool),
}
"""Property, number of components and data type of each attribute type. Other types are lost."""

ON_EDGE = 1e-7
"""Barycentric coordinates below this are treated as 0.

Smaller than the rounding error of two of them in single precision, it misses edges that are not
split at their midpoint. Larger, it takes a short edge near another edge for a part of it.
"""

NUMBERS_IN_PART = 1 << 20
"""Triangle numbers are stored as quotient and remainder of a division by this.

Larger than 2^24, single precision cannot represent all remainders. Smaller, it cannot represent all
quotients of large meshes.
"""


class Surface:
    """Triangles of the polygons of `target`, with the vertex, loop and polygon of every corner.

    mirrored: whether to reverse the triangles, as a negative scale of the object does.
    """

    def __init__(self, target, mirrored):
        self.target, self.mesh, self.order = target, target.data, -1 if mirrored else 1
        self.mesh.calc_loop_triangles()
        faces = self.mesh.loop_triangles
        self.positions = read(self.mesh.vertices, "co", 3, np.float32).astype(float)
        self.loops = read(faces, "loops", 3, np.int32)[:, :: self.order]
        self.triangles = read(faces, "vertices", 3, np.int32)[:, :: self.order]
        self.polygons = read(faces, "polygon_index", 1, np.int32)

    def uvs(self):
        """Returns two sets of texture coordinates that identify the source of each refined corner.

        The first set has the barycentric coordinates of the second and third corner. The second has
        the number of the triangle, the same at all corners, so that all parts of a triangle inherit
        it. Two components store the number in single precision.
        """
        corners = np.tile([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], (len(self.triangles), 1, 1))
        parts = np.divmod(np.arange(len(self.triangles)), NUMBERS_IN_PART)
        numbers = np.repeat(np.stack(parts, axis=1)[:, None], 3, axis=1)
        return [corners, numbers]

    def normals(self):
        """Custom normals per corner, (triangles, 3, 3), or None if the mesh has none."""
        return read(self.mesh.corner_normals, "vector", 3, np.float32)[self.loops] if self.mesh.has_custom_normals else None

    def set_normals(self, normals):
        """Sets custom normals of any nonzero length at the corners of the current triangles."""
        by_loop = np.zeros((len(self.mesh.loops), 3))
        by_loop[self.loops] = normals / np.linalg.norm(normals, axis=2, keepdims=True)
        self.mesh.normals_split_custom_set(by_loop.tolist())

    def move(self, positions):
        """Moves the vertices and keeps the polygons. Returns the names of lost attributes: none."""
        self.mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
        self.mesh.update()
        return []

    def replace(self, positions, triangles, uvs):
        """Replaces the polygons by refined triangles. Returns the names of lost attributes.

        `uvs` are the interpolated sets of `self.uvs()`.
        """
        corners, numbers = uvs
        corners = corners.astype(float)
        weights = np.dstack([1.0 - corners.sum(axis=2), corners])[:, :: self.order, :]
        source = np.rint(numbers[:, 0]).astype(int) @ [NUMBERS_IN_PART, 1]
        triangles = triangles[:, :: self.order].astype(np.int32)
        attributes, lost = self._attributes()
        groups = [(group.name, group.lock_weight) for group in self.target.vertex_groups]
        active_group = self.target.vertex_groups.active_index
        group_weights, members = self._group_weights()
        edges = read(self.mesh.edges, "vertices", 2, np.int32)
        uv_layers, colors = self.mesh.uv_layers, self.mesh.color_attributes
        shown_uvs = uv_layers.active_index, [layer.active_render for layer in uv_layers]
        shown_colors = colors.active_color_index, colors.render_color_index

        self._rebuild(positions, triangles)
        # Any corner of a new vertex identifies its source. The old vertices come first, including loose ones.
        corner = np.zeros(len(positions), int)
        corner[triangles.ravel()] = np.arange(triangles.size)
        vertices, coordinates = self.triangles[source].repeat(3, axis=0)[corner], weights.reshape(-1, 3)[corner]
        old = len(self.positions)
        vertices[:old], coordinates[:old] = np.arange(old)[:, None], [1.0, 0.0, 0.0]
        at = {
            "POINT": (vertices, coordinates),
            "CORNER": (self.loops[source].repeat(3, axis=0), weights.reshape(-1, 3)),
            "FACE": (self.polygons[source][:, None], np.ones((len(source), 1))),
            "EDGE": self._edges(triangles, source, weights, edges),
        }
        for name, kind, domain, values in attributes:
            found = self.mesh.attributes.get(name) or self.mesh.attributes.new(name, kind, domain)
            field = FIELDS[kind][0]
            found.data.foreach_set(field, interpolated(values, *at[domain]).ravel())
        self._set_groups(groups, *(interpolated(values, *at["POINT"]) for values in (group_weights, members)))
        self.target.vertex_groups.active_index = active_group
        if uv_layers:
            uv_layers.active_index = shown_uvs[0]
            for layer, active in zip(uv_layers, shown_uvs[1], strict=True):
                layer.active_render = active
        if colors:
            colors.active_color_index, colors.render_color_index = shown_colors
        self.mesh.update()
        self.loops = np.arange(triangles.size).reshape(-1, 3)[:, :: self.order]
        return lost

    def _rebuild(self, positions, triangles):
        mesh = self.mesh
        mesh.clear_geometry()
        mesh.vertices.add(len(positions))
        mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
        mesh.loops.add(triangles.size)
        mesh.loops.foreach_set("vertex_index", triangles.ravel())
        mesh.polygons.add(len(triangles))
        mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
        mesh.update(calc_edges=True)

    def _attributes(self):
        """Returns name, type, domain and values of attributes, and the names of unsupported ones.

        Topology and selection are excluded. Names that begin with a dot are internal attributes
        that Blender regenerates. Custom normals are stored relative to the surface, so they are set
        again instead.
        """
        excluded = ["position", "custom_normal"]
        named = [a for a in self.mesh.attributes if not a.name.startswith(".") and a.name not in excluded]
        lost = [a.name for a in named if a.data_type not in FIELDS]
        kept = [a for a in named if a.data_type in FIELDS]
        return [(a.name, a.data_type, a.domain, read(a.data, *FIELDS[a.data_type])) for a in kept], lost

    def _group_weights(self):
        """Returns weights and memberships (1 for members), (vertices, groups) each."""
        weights = np.zeros((2, len(self.positions), len(self.target.vertex_groups)), np.float32)
        for vertex in self.mesh.vertices:
            for group in vertex.groups:
                weights[:, vertex.index, group.group] = group.weight, 1.0
        return weights

    def _set_groups(self, groups, weights, members):
        for index, (name, locked) in enumerate(groups):
            group = self.target.vertex_groups.new(name=name)
            group.lock_weight = locked
            for vertex in np.flatnonzero(members[:, index] > 0).tolist():
                group.add([vertex], min(float(weights[vertex, index]), 1.0), "REPLACE")

    def _edges(self, triangles, source, weights, edges):
        """Returns, for each new edge, the old edge that contains it and 1, or 0 if none does."""
        count = triangles.max() + 1
        ends, old_ends = np.roll(triangles, -1, axis=1), self.triangles[source][:, :: self.order]
        at, found = np.zeros((len(self.mesh.edges), 1), int), np.zeros((len(self.mesh.edges), 1))
        new, old = edge_keys(read(self.mesh.edges, "vertices", 2, np.int32), count), edge_keys(edges, count)
        new_order, old_order = np.argsort(new), np.argsort(old)
        across = np.abs(weights) < ON_EDGE
        across &= np.roll(across, -1, axis=1)
        for opposite in range(3):
            triangle, corner = np.nonzero(across[:, :, opposite])
            part = edge_keys(np.stack([triangles[triangle, corner], ends[triangle, corner]], axis=1), count)
            whole = edge_keys(np.delete(old_ends, opposite, axis=1)[triangle], count)
            part = new_order[np.searchsorted(new, part, sorter=new_order)]
            index = np.minimum(np.searchsorted(old, whole, sorter=old_order), len(old) - 1)
            # Diagonals of polygons are not edges of the mesh.
            index = old_order[index]
            real = old[index] == whole
            at[part[real], 0], found[part[real], 0] = index[real], 1.0
        return at, found


def edge_keys(ends, count):
    """Returns one number for every unordered pair of vertices."""
    ends = np.sort(ends.astype(np.int64), axis=1)
    return ends[:, 0] * count + ends[:, 1]


def read(collection, field, width, kind):
    """Reads the property `field` of a collection, (N, width), or (N,) if width is 1."""
    values = np.empty(len(collection) * width, kind)
    collection.foreach_get(field, values)
    return values.reshape(-1, width) if width > 1 else values


def interpolated(values, at, weights):
    """Returns the sums of `values[at]` weighted by `weights`.

    Values that are not floating-point are taken from the largest weight, or 0 if all weights are 0.
    """
    if values.dtype != np.float32:
        rows, heaviest = np.arange(len(at)), weights.argmax(axis=1)
        return values[at[rows, heaviest]] * (weights[rows, heaviest] > 0)
    return np.einsum("nk,nk...->n...", weights, values[at]).astype(np.float32)
