/* Presses a ball into a block of clay and writes the result to FILE, if given. Usage: press [FILE] */

#include <isochore.h>
#include <stdbool.h>
#include <stdio.h>

static const char *const RECIPE =
    "recipe = 1\n"
    "[target]\n"
    "shape = { kind = 'box', half_extents = [1, 1, 0.5], segments = [20, 20, 10] }\n"
    "[tools.ball]\n"
    "shape = { kind = 'sphere', radius = 0.4 }\n"
    "support = 0.3\n"
    "[[stroke]]\n"
    "kind = 'move'\n"
    "tool = 'ball'\n"
    "keys = [ { at = [0, 0, 1.2] }, { at = [0, 0, 0.6] } ]\n";

static bool show_progress(const char *stage, double done, void *context) {
    (void)context;
    fprintf(stderr, "%s %.0f %%\n", stage, 100 * done);
    return true;
}

int main(int count, char **arguments) {
    IsochoreMesh *pressed = NULL;
    char *report = NULL;
    double volume = 0;

    IsochoreStatus status = isochore_run(RECIPE, NULL, 0, show_progress, NULL, &pressed, &report);
    if (status == ISOCHORE_STATUS_OK) {
        status = isochore_mesh_volume(pressed, &volume);
    }
    if (status == ISOCHORE_STATUS_OK && count > 1) {
        status = isochore_mesh_write(pressed, arguments[1]);
    }
    if (status == ISOCHORE_STATUS_OK) {
        printf("%zu triangles, volume %.9f\n", isochore_mesh_triangle_count(pressed), volume);
    } else {
        fprintf(stderr, "error %d: %s\n", (int)status, isochore_last_error());
    }
    isochore_text_free(report);
    isochore_mesh_free(pressed);
    return status == ISOCHORE_STATUS_OK ? 0 : 1;
}
