"""Object > Deform by Recipe: deforms the active mesh by an isochore recipe.

The active mesh replaces the target that the recipe names. The Python package `isochore` must be
installed in Blender's Python: install it there with pip, or add its wheel to
`blender_manifest.toml`.
"""

import json
import pathlib
import tomllib

import bpy

import isochore

from .deformation import Deformation

REPORTED = isochore.Error, OSError, ValueError
"""Exceptions that are reported to the user."""

INTERVAL = 0.1
"""Seconds between two updates of the progress display."""


class OBJECT_OT_isochore_deform(bpy.types.Operator):
    """Deform the active mesh by a recipe in world space. Refinement triangulates the mesh"""

    bl_idname = "object.isochore_deform"
    bl_label = "Deform by Recipe"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(name="Recipe", description="Recipe file, TOML or JSON", subtype="FILE_PATH")
    text: bpy.props.StringProperty(name="Text", description="Text block that contains the recipe. If set, no file is read")
    filter_glob: bpy.props.StringProperty(default="*.toml;*.json", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH" and context.mode == "OBJECT"

    deformation = None
    is_interactive = False
    """Whether to run in the background, with progress and Esc to stop. Scripts wait instead."""

    def invoke(self, context, event):
        self.is_interactive = True
        if self.text:
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        manager = context.window_manager
        try:
            self.deformation = Deformation(context.object, self._recipe())
        except REPORTED as error:
            return self._fail(error)
        manager.progress_begin(0, 1)
        if self.is_interactive:
            self.deformation.start()
            self.timer = manager.event_timer_add(INTERVAL, window=context.window)
            manager.modal_handler_add(self)
            return {"RUNNING_MODAL"}
        self.deformation.run(lambda stage, done: manager.progress_update(done))
        return self._finish(context)

    def modal(self, context, event):
        # The operator consumes all other events, so that the mesh cannot be edited meanwhile.
        if event.type == "ESC":
            self.deformation.stop()
        elif event.type == "TIMER" and self.deformation.is_done():
            context.window_manager.event_timer_remove(self.timer)
            context.workspace.status_text_set(None)
            return self._finish(context)
        else:
            stage, done = self.deformation.progress
            context.window_manager.progress_update(done)
            context.workspace.status_text_set(f"{stage} {done:.0%}    Esc: stop")
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        # Blender calls this when it closes the file. It also does so while the file dialog is open.
        if self.deformation:
            self.deformation.stop()

    def _finish(self, context):
        context.window_manager.progress_end()
        try:
            report, lost = self.deformation.finish()
        except isochore.Cancelled:
            return {"CANCELLED"}
        except REPORTED as error:
            return self._fail(error)
        missed = [name for name, held in report["promises"].items() if not held]
        if missed:
            self.report({"WARNING"}, "Promises not met: " + ", ".join(missed))
        if lost:
            self.report({"WARNING"}, "Attributes lost: " + ", ".join(lost))
        change = "open surface" if report["volume_change"] is None else f"volume change {report['volume_change']:+.1e}"
        self.report({"INFO"}, f"{report['after']['triangles']} triangles, {change}")
        return {"FINISHED"}

    def _fail(self, error):
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _recipe(self):
        if not self.text:
            return pathlib.Path(bpy.path.abspath(self.filepath))
        if self.text not in bpy.data.texts:
            raise ValueError(f"text block `{self.text}` does not exist")
        text = bpy.data.texts[self.text].as_string()
        return json.loads(text) if text.lstrip().startswith("{") else tomllib.loads(text)


def draw_menu(menu, context):
    menu.layout.operator_context = "INVOKE_DEFAULT"
    menu.layout.operator(OBJECT_OT_isochore_deform.bl_idname)


def register():
    bpy.utils.register_class(OBJECT_OT_isochore_deform)
    bpy.types.VIEW3D_MT_object.append(draw_menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(draw_menu)
    bpy.utils.unregister_class(OBJECT_OT_isochore_deform)
