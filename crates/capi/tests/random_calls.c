/* Makes ten thousand random calls, including invalid ones, and checks that the session stays consistent. The argument is the path of a
 * file, which this test ignores. */

#include <isochore.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                       \
    do {                                                                                       \
        if (!(condition)) {                                                                    \
            fprintf(stderr, "%s:%d: call %d: %s (%s)\n", __FILE__, __LINE__, calls, #condition, isochore_last_error()); \
            exit(1);                                                                           \
        }                                                                                      \
    } while (0)

#define CALLS 10000

/* A cube. It is small so that ten thousand calls are fast even under valgrind. */
static const double CORNERS[] = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1};
static const uint32_t FACES[] = {0, 3, 2, 0, 2, 1, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
static const char *const BALL = "{\"shape\": {\"kind\": \"sphere\", \"radius\": 0.3}, \"support\": 0.5}";

static int calls = 0;

/* Pseudorandom numbers in [0, 1): a linear congruential generator (D. Lehmer) with the multiplier of P. L'Ecuyer (1999). */
static double number(void) {
    static uint64_t state = 1;
    state = state * UINT64_C(0xd1342543de82ef95) + 1;
    return (double)(state >> 11) / (double)(UINT64_C(1) << 53);
}

static uint32_t below(uint32_t count) { return (uint32_t)(number() * count); }

static void anywhere(double point[3]) {
    for (int axis = 0; axis < 3; axis++) {
        point[axis] = 3 * number() - 1.5;
    }
}

/* One step of a random walk that stays near the cube. */
static void walk(double point[3]) {
    for (int axis = 0; axis < 3; axis++) {
        point[axis] = 0.95 * point[axis] + number() - 0.5;
    }
}

static IsochoreMesh *cube(void) {
    IsochoreMesh *mesh = NULL;
    CHECK(isochore_mesh_new(CORNERS, 8, FACES, 12, &mesh) == ISOCHORE_STATUS_OK);
    if (below(2)) {
        uint32_t joints[16];
        double weights[16];
        for (int i = 0; i < 16; i++) {
            joints[i] = below(5);
            weights[i] = number();
        }
        CHECK(isochore_mesh_set_skin(mesh, 2, joints, weights) == ISOCHORE_STATUS_OK);
    }
    return mesh;
}

static IsochoreSession *opened(IsochoreMesh *mesh) {
    IsochoreSession *session = NULL;
    IsochoreSessionOptions options;
    double weights[8];
    memset(&options, 0, sizeof options);
    /* The small budget makes the session drop old strokes from the history. */
    options.undo_bytes = below(2) ? 20000 : 0;
    if (below(2)) {
        for (int vertex = 0; vertex < 8; vertex++) {
            weights[vertex] = below(2);
        }
        options.weights = weights;
        options.weight_count = 8;
        options.mask = "{\"fade\": 0.5}";
    }
    CHECK(isochore_session_new(mesh, &options, &session) == ISOCHORE_STATUS_OK);
    return session;
}

/* Reads all buffers and changed ranges of the session. */
static void look_at(IsochoreSession *session) {
    IsochoreBuffers buffers;
    const IsochoreRange *ranges = NULL;
    size_t count = 0;
    double sum = 0;
    CHECK(isochore_session_take_changes(session) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_buffers(session, &buffers) == ISOCHORE_STATUS_OK);
    for (size_t i = 0; i < 3 * buffers.vertex_count; i++) {
        sum += buffers.positions[i] + buffers.normals[i];
    }
    CHECK(isfinite(sum));
    for (size_t i = 0; i < 3 * buffers.triangle_count; i++) {
        CHECK(buffers.indices[i] < buffers.vertex_count);
    }
    for (uint32_t buffer = 0; buffer < 4; buffer++) {
        CHECK(isochore_session_changed(session, buffer, &ranges, &count) == ISOCHORE_STATUS_OK);
        size_t rows = buffer == ISOCHORE_BUFFER_INDICES ? buffers.triangle_count : buffers.vertex_count;
        for (size_t i = 0; i < count; i++) {
            CHECK(ranges[i].start < ranges[i].end && ranges[i].end <= rows);
        }
    }
}

/* Exports the surface and checks the exported mesh. */
static void export_from(IsochoreSession *session) {
    IsochoreMesh *mesh = NULL;
    const uint32_t *vertices = NULL, *map = NULL;
    size_t count = 0, opened_count = 0;
    double volume = 0;
    CHECK(isochore_session_export(session, below(2), &mesh) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_vertices(session, &vertices, &count) == ISOCHORE_STATUS_OK);
    CHECK(count == isochore_mesh_vertex_count(mesh));
    for (size_t i = 1; i < count; i++) {
        CHECK(vertices[i - 1] < vertices[i]);
    }
    /* Each vertex of the cube maps to an existing vertex. */
    CHECK(isochore_session_vertex_map(session, &map, &opened_count) == ISOCHORE_STATUS_OK && opened_count == 8);
    for (size_t vertex = 0; vertex < opened_count; vertex++) {
        size_t index = 0;
        while (index < count && vertices[index] != map[vertex]) {
            index++;
        }
        CHECK(index < count);
    }
    CHECK(isochore_mesh_volume(mesh, &volume) == ISOCHORE_STATUS_OK && isfinite(volume));
    size_t values = isochore_mesh_vertex_count(mesh) * isochore_mesh_skin_influences(mesh);
    if (values > 0) {
        uint32_t *joints = (uint32_t *)malloc(values * sizeof *joints);
        double *weights = (double *)malloc(values * sizeof *weights);
        CHECK(isochore_mesh_skin(mesh, joints, weights) == ISOCHORE_STATUS_OK);
        for (size_t i = 0; i < values; i++) {
            CHECK(joints[i] < 5 && weights[i] >= 0 && weights[i] <= 1);
        }
        free(joints);
        free(weights);
    }
    isochore_mesh_free(mesh);
}

static void ask(IsochoreSession *session, IsochoreTool *tool) {
    double from[3], to[3], outward = 0, inward = 0;
    const uint32_t *vertices = NULL;
    const IsochoreArrow *arrows = NULL;
    IsochoreBuffers buffers;
    IsochoreOrigin origin;
    IsochoreHit hit;
    size_t count = 0;
    bool is_hit = false;
    char *log = NULL;
    anywhere(from);
    anywhere(to);
    switch (below(7)) {
    case 0:
        CHECK(isochore_session_pick(session, from, to, &hit, &is_hit) == ISOCHORE_STATUS_OK);
        break;
    case 1:
        CHECK(isochore_session_closest_point(session, from, &hit, &is_hit) == ISOCHORE_STATUS_OK && is_hit);
        break;
    case 2:
        CHECK(isochore_session_vertices_in_reach(session, tool, from, NULL, &vertices, &count) == ISOCHORE_STATUS_OK);
        for (size_t i = 1; i < count; i++) {
            CHECK(vertices[i - 1] < vertices[i]);
        }
        break;
    case 3:
        CHECK(isochore_session_preview(session, tool, from, NULL, to, NULL, 4, &arrows, &count) == ISOCHORE_STATUS_OK);
        for (size_t i = 0; i < count; i++) {
            CHECK(isfinite(arrows[i].point[0] + arrows[i].shift[0]));
        }
        break;
    case 4:
        CHECK(isochore_session_buffers(session, &buffers) == ISOCHORE_STATUS_OK);
        CHECK(isochore_session_origin(session, below((uint32_t)buffers.vertex_count), &origin) == ISOCHORE_STATUS_OK);
        break;
    case 5:
        CHECK(isochore_session_moved_volume(session, &outward, &inward) == ISOCHORE_STATUS_OK && outward >= 0 && inward >= 0);
        break;
    default:
        CHECK(isochore_session_log(session, &log) == ISOCHORE_STATUS_OK && log[0] == '{');
        isochore_text_free(log);
    }
}

static void make_faults(IsochoreSession *session, IsochoreTool *tool) {
    const double nowhere[] = {0, INFINITY, 0}, turn[] = {0, 0, 0, NAN};
    const uint32_t beyond = 1u << 31;
    IsochoreOrigin origin;
    IsochoreMesh *mesh = NULL;
    CHECK(isochore_session_move_to(session, nowhere, NULL, 1e9, NULL) != ISOCHORE_STATUS_OK);
    CHECK(isochore_session_move_to(session, NULL, NULL, 1e9, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_preview(session, tool, CORNERS, turn, CORNERS, NULL, 4, NULL, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_origin(session, UINT32_MAX, &origin) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_freeze_edges(session, &beyond, 1) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_export(session, false, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_export(NULL, false, &mesh) == ISOCHORE_STATUS_ARGUMENT && mesh == NULL);
    CHECK(isochore_session_begin_stroke(session, NULL, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strlen(isochore_last_error()) > 0);
}

int main(void) {
    IsochoreMesh *mesh = cube();
    IsochoreTool *tool = NULL;
    IsochoreSession *session = opened(mesh);
    double time = 0;
    double at[3] = {0, 0, 0};
    size_t forgotten = 0, edits = 0;
    CHECK(isochore_tool_new("ball", BALL, NULL, 0, NULL, NULL, &tool) == ISOCHORE_STATUS_OK);
    for (calls = 0; calls < CALLS; calls++) {
        const double turn[4] = {1, 2, 3, 120 * number()}, keep[4] = {at[0], at[1], at[2], number()};
        const IsochoreStrokeOptions options = {below(4) == 0, 0.4 + 0.4 * number(), 200, keep, below(2), 0};
        uint32_t frozen[2] = {below(8), below(8)};
        IsochoreStatus status = ISOCHORE_STATUS_OK;
        IsochoreMoveReceipt move;
        IsochoreStrokeReceipt receipt;
        bool is_done;
        memset(&receipt, 0, sizeof receipt);
        /* About half of the calls that begin, move and end strokes come out of order. */
        switch (below(16)) {
        case 0:
        case 1:
            status = isochore_session_begin_stroke(session, tool, &options);
            break;
        case 2:
        case 3:
        case 4:
        case 5:
            walk(at);
            status = isochore_session_move_to(session, at, below(2) ? turn : NULL, time += number(), &move);
            break;
        case 6:
            status = isochore_session_end_stroke(session, below(4) ? &receipt : NULL);
            forgotten += receipt.forgotten_strokes;
            edits += receipt.inserted_vertices + receipt.removed_vertices + receipt.flipped_edges;
            break;
        case 7:
            status = below(3) ? ISOCHORE_STATUS_OK : isochore_session_cancel_stroke(session);
            break;
        case 8:
            status = isochore_session_undo(session, below(2) ? &is_done : NULL);
            break;
        case 9:
            status = isochore_session_redo(session, below(2) ? &is_done : NULL);
            break;
        case 10:
            look_at(session);
            break;
        case 11:
            CHECK(isochore_session_freeze_edges(session, frozen, below(3)) == ISOCHORE_STATUS_OK);
            break;
        case 12:
            make_faults(session, tool);
            break;
        case 13:
            if (below(4) == 0) {
                export_from(session);
            }
            break;
        case 14:
            if (below(40) == 0) {
                isochore_mesh_free(mesh);
                isochore_session_free(session);
                mesh = cube();
                session = opened(mesh);
                time = 0;
            }
            break;
        default:
            ask(session, tool);
        }
        CHECK(status == ISOCHORE_STATUS_OK || status == ISOCHORE_STATUS_STATE);
    }
    CHECK(edits > 1000 && forgotten > 0);
    isochore_session_free(session);
    isochore_tool_free(tool);
    isochore_mesh_free(mesh);
    return 0;
}
