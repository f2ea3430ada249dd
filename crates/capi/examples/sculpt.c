/* Makes one stroke in a session, as an interactive host would, and writes the result to FILE, if given. Usage: sculpt [FILE] */

#include <isochore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check(IsochoreStatus status) {
    if (status != ISOCHORE_STATUS_OK) {
        fprintf(stderr, "error %d: %s\n", (int)status, isochore_last_error());
        exit(1);
    }
}

/* Copies the changed rows of the position buffer, as a renderer would, and returns their number. */
static size_t upload(IsochoreSession *session, float **copy) {
    IsochoreBuffers buffers;
    const IsochoreRange *ranges;
    size_t count, rows = 0;
    check(isochore_session_take_changes(session));
    check(isochore_session_buffers(session, &buffers));
    check(isochore_session_changed(session, ISOCHORE_BUFFER_POSITIONS, &ranges, &count));
    *copy = (float *)realloc(*copy, buffers.vertex_count * 3 * sizeof(float));
    for (size_t i = 0; i < count; i++) {
        size_t start = ranges[i].start, length = ranges[i].end - start;
        memcpy(*copy + 3 * start, buffers.positions + 3 * start, length * 3 * sizeof(float));
        rows += length;
    }
    if (memcmp(*copy, buffers.positions, buffers.vertex_count * 3 * sizeof(float)) != 0) {
        fprintf(stderr, "error: the copy differs\n");
        exit(1);
    }
    return rows;
}

int main(int count, char **arguments) {
    IsochoreMesh *clay = NULL, *result = NULL;
    IsochoreTool *brush = NULL;
    IsochoreSession *session = NULL;
    IsochoreMoveReceipt move;
    IsochoreStrokeReceipt receipt;
    float *copy = NULL;

    check(isochore_run("recipe = 1\n[target]\nshape = { kind = 'icosphere', radius = 1.0, subdivisions = 5 }\n", NULL, 0, NULL,
                       NULL, &clay, NULL));
    check(isochore_tool_new("brush", "{\"shape\": {\"kind\": \"sphere\", \"radius\": 0.2}, \"support\": 0.3}", NULL, 0, NULL, NULL,
                            &brush));
    check(isochore_session_new(clay, NULL, &session));
    printf("initial upload: %zu rows\n", upload(session, &copy));

    check(isochore_session_begin_stroke(session, brush, NULL));
    for (int step = 0; step < 6; step++) {
        const double at[3] = {0.1 * step, 0, 1.2 - 0.04 * step};
        check(isochore_session_move_to(session, at, NULL, step / 60.0, &move));
        printf("move %d: %zu vertices, %zu rows\n", step, move.moved_vertices, upload(session, &copy));
    }
    check(isochore_session_end_stroke(session, &receipt));
    printf("%zu moves, %zu vertices touched, %zu inserted, volume %+.1e\n", receipt.moves, receipt.touched_vertices,
           receipt.inserted_vertices, receipt.volume_flow + receipt.volume_splits + receipt.volume_remeshing);

    check(isochore_session_export(session, true, &result));
    if (count > 1) {
        check(isochore_mesh_write(result, arguments[1]));
    }
    free(copy);
    isochore_mesh_free(result);
    isochore_session_free(session);
    isochore_tool_free(brush);
    isochore_mesh_free(clay);
    return 0;
}
