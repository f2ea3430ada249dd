"""Object > Deform by Recipe: the active mesh takes the place of the mesh that the recipe names as its target.

Blender's Python needs the package too: `pip install` it into that, or add its wheel to `blender_manifest.toml`.
"""

import json
import pathlib
import tomllib

import bpy
import numpy as np

import isochore

from .surface import Surface

TARGET = "the active mesh"
"""What the target is called while the recipe runs; no file of a recipe has this name."""


class OBJECT_OT_isochore_deform(bpy.types.Operator):
    """Deform the active mesh by a recipe of isochore, in world space. Where it is refined it becomes triangles"""

    bl_idname = "object.isochore_deform"
    bl_label = "Deform by Recipe"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(name="Recipe", description="TOML or JSON file", subtype="FILE_PATH")
    text: bpy.props.StringProperty(name="Text", description="Text block with the recipe, instead of a file")
    filter_glob: bpy.props.StringProperty(default="*.toml;*.json", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH" and context.mode == "OBJECT"

    def invoke(self, context, event):
        if self.text:
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        try:
            report, lost = deform(context.object, self._recipe())
        except (isochore.Error, OSError, ValueError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        missed = [name for name, held in report["promises"].items() if not held]
        if missed:
            self.report({"WARNING"}, "promises missed: " + ", ".join(missed))
        if lost:
            self.report({"WARNING"}, "attributes that could not be carried: " + ", ".join(lost))
        change = "open" if report["volume_change"] is None else f"volume {report['volume_change']:+.1e}"
        self.report({"INFO"}, f"{report['after']['triangles']} triangles, {change}")
        return {"FINISHED"}

    def _recipe(self):
        if not self.text:
            return pathlib.Path(bpy.path.abspath(self.filepath))
        if self.text not in bpy.data.texts:
            raise ValueError(f"there is no text block `{self.text}`")
        text = bpy.data.texts[self.text].as_string()
        return json.loads(text) if text.lstrip().startswith("{") else tomllib.loads(text)


def deform(target, recipe):
    """Deforms the mesh of the object `target`; the report, and the names of attributes that were lost.

    `recipe` is a path, or keys. Their lengths are those of the world. The object's own transform stays as it is.
    """
    if target.data.shape_keys:
        raise ValueError("a mesh with shape keys cannot be refined: apply or remove them first")
    to_world = np.array(target.matrix_world)
    if np.linalg.det(to_world[:3, :3]) == 0:
        raise ValueError("the object is scaled to nothing along some axis")
    surface = Surface(target, mirrored=np.linalg.det(to_world[:3, :3]) < 0)
    world = surface.positions @ to_world[:3, :3].T + to_world[:3, 3]
    normals = surface.normals()
    if normals is not None:
        normals = normals @ np.linalg.inv(to_world[:3, :3])
    sent = isochore.Mesh(world, surface.triangles, uvs=surface.uvs(), normals=normals)
    mesh, _, report = isochore.run(recipe, meshes={TARGET: sent}, settings={"target.mesh": TARGET})
    local = (mesh.positions - to_world[:3, 3]) @ np.linalg.inv(to_world[:3, :3]).T
    # What did not move keeps its bits, which the way to the world and back would not.
    still = np.all(mesh.positions[: len(world)] == world, axis=1)
    local[: len(world)][still] = surface.positions[still]
    is_same = np.array_equal(mesh.triangles, surface.triangles)
    lost = surface.move(local) if is_same else surface.replace(local, mesh.triangles, mesh.uvs)
    if normals is not None:
        surface.set_normals(mesh.normals @ to_world[:3, :3])
    return report, lost


def draw_menu(menu, context):
    menu.layout.operator_context = "INVOKE_DEFAULT"
    menu.layout.operator(OBJECT_OT_isochore_deform.bl_idname)


def register():
    bpy.utils.register_class(OBJECT_OT_isochore_deform)
    bpy.types.VIEW3D_MT_object.append(draw_menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(draw_menu)
    bpy.utils.unregister_class(OBJECT_OT_isochore_deform)
