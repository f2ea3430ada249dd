"""Conversion from and to trimesh, with texture coordinates, colors and materials.

trimesh stores these per vertex, so its meshes have duplicate vertices at seams. Duplicates are
welded when a mesh is imported, which closes the surface, and split again when it is exported.
"""

import numpy as np

from isochore._native import Mesh


def from_trimesh(other):
    """Converts an object with `vertices`, `faces` and an optional `visual`."""
    if not (hasattr(other, "vertices") and hasattr(other, "faces")):
        raise TypeError(f"expected a mesh or an object with vertices and faces, not {type(other).__name__}")
    faces = np.asarray(other.faces)
    visual = getattr(other, "visual", None)
    kind = getattr(visual, "kind", None)
    if kind == "texture":
        attributes = {**_uvs(visual, faces), **_materials(visual, len(faces))}
        if (colors := visual.vertex_attributes.get("color")) is not None:
            attributes["colors"] = _rgba(colors)
    elif kind == "vertex":
        attributes = {"colors": _rgba(visual.vertex_colors)}
    elif kind == "face":
        attributes = {"corner_colors": _rgba(visual.face_colors)[:, None].repeat(3, axis=1)}
    else:
        # No attribute can differ across a seam, so no duplicates need welding.
        return Mesh(other.vertices, faces)
    return Mesh(other.vertices, faces, **attributes).welded()


def to_trimesh(mesh):
    """Converts to a `trimesh.Trimesh`. See the type stubs."""
    import trimesh
    from trimesh.visual import ColorVisuals, TextureVisuals

    corner_colors = mesh.corner_colors
    is_by_face = corner_colors is not None and np.array_equal(corner_colors, corner_colors[:, :1].repeat(3, axis=1))
    has_texture = bool(mesh.uvs or mesh.materials)
    if is_by_face and not has_texture:
        visual = ColorVisuals(face_colors=_bytes(corner_colors[:, 0]))
        return trimesh.Trimesh(mesh.positions, mesh.triangles, process=False, visual=visual)
    seams = Mesh(mesh.positions, mesh.triangles, uvs=mesh.uvs[:1], corner_colors=corner_colors)
    vertices, triangles = seams.split_at_seams()

    def by_vertex(corners):
        values = np.zeros((len(vertices), corners.shape[2]))
        values[triangles] = corners
        return values

    colors = None
    if corner_colors is not None:
        colors = _bytes(by_vertex(corner_colors))
    elif mesh.colors is not None:
        colors = _bytes(mesh.colors[vertices])
    if has_texture:
        visual = TextureVisuals(by_vertex(mesh.uvs[0]) if mesh.uvs else None, **_visual_materials(mesh))
        if colors is not None:
            visual.vertex_attributes["color"] = colors
    else:
        visual = ColorVisuals(vertex_colors=colors)
    return trimesh.Trimesh(mesh.positions[vertices], triangles, process=False, visual=visual)


def _uvs(visual, faces):
    return {} if visual.uv is None or len(visual.uv) == 0 else {"uvs": [np.asarray(visual.uv)[faces]]}


def _materials(visual, count):
    several = getattr(visual.material, "materials", None)
    names = [material.name or "" for material in (several or [visual.material])]
    numbers = np.zeros(count, int) if several is None else visual.face_materials
    # trimesh keeps the material list at its old length when it removes faces.
    if not any(names) or numbers is None or len(numbers) != count:
        return {}
    return {"materials": names, "triangle_materials": numbers}


def _visual_materials(mesh):
    from trimesh.visual.material import MultiMaterial, SimpleMaterial

    materials = [SimpleMaterial(name=name) for name in mesh.materials or [""]]
    if len(materials) == 1:
        return {"material": materials[0]}
    return {"material": MultiMaterial(materials), "face_materials": mesh.triangle_materials}


def _rgba(colors):
    """Converts integer or floating-point RGB or RGBA to colors (N, 4) from 0 to 1."""
    colors = np.asarray(colors)
    if not np.issubdtype(colors.dtype, np.floating):
        colors = colors / np.iinfo(colors.dtype).max
    return colors if colors.shape[1] == 4 else np.hstack([colors, np.ones((len(colors), 1))])


def _bytes(colors):
    return np.rint(np.clip(colors, 0, 1) * 255).astype(np.uint8)
