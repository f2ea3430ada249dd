/* Tests of the C interface: arrays in and out, error messages, cancellation. The argument is the path of a file to write. */

/* For mkdtemp. */
#define _XOPEN_SOURCE 700

#include <isochore.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CHECK(condition)                                                                       \
    do {                                                                                       \
        if (!(condition)) {                                                                    \
            fprintf(stderr, "%s:%d: %s (%s)\n", __FILE__, __LINE__, #condition, isochore_last_error()); \
            exit(1);                                                                           \
        }                                                                                      \
    } while (0)

static const double CORNERS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t FACES[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

static const char *const BALL = "{\"shape\": {\"kind\": \"sphere\", \"radius\": 0.3}, \"support\": 0.3}";
static const char *const WIDE_BALL = "{\"shape\": {\"kind\": \"sphere\", \"radius\": 0.4}, \"support\": 1}";
static const IsochoreStrokeOptions UNREFINED = {true, 0, 0, NULL, 0, 0}, FINE = {false, 0.2, 0, NULL, 0, 0};

static const char *const TWIST =
    "{ \"recipe\": 1, \"target\": { \"mesh\": \"tetrahedron\" }, \"stroke\": [ { \"kind\": \"twist\","
    " \"origin\": [0, 0, 0], \"axis\": [0, 0, 1], \"degrees_per_unit\": 10.0 } ] }";

static bool stop(const char *stage, double done, void *context) {
    CHECK(strlen(stage) > 0 && done >= 0 && done <= 1);
    *(int *)context += 1;
    return false;
}

static IsochoreMesh *tetrahedron(void) {
    IsochoreMesh *mesh = NULL;
    CHECK(isochore_mesh_new(CORNERS, 4, FACES, 4, &mesh) == ISOCHORE_STATUS_OK);
    return mesh;
}

static void meshes(const char *path) {
    IsochoreMesh *mesh = tetrahedron();
    CHECK(isochore_mesh_vertex_count(mesh) == 4 && isochore_mesh_triangle_count(mesh) == 4);
    CHECK(memcmp(isochore_mesh_positions(mesh), CORNERS, sizeof CORNERS) == 0);
    CHECK(memcmp(isochore_mesh_triangles(mesh), FACES, sizeof FACES) == 0);
    double volume = 0;
    CHECK(isochore_mesh_volume(mesh, &volume) == ISOCHORE_STATUS_OK && fabs(volume - 1.0 / 6) < 1e-15);

    IsochoreMesh *read = NULL;
    CHECK(isochore_mesh_write(mesh, path) == ISOCHORE_STATUS_OK);
    CHECK(isochore_mesh_read(path, &read) == ISOCHORE_STATUS_OK);
    CHECK(memcmp(isochore_mesh_positions(read), CORNERS, sizeof CORNERS) == 0);
    isochore_mesh_free(read);
    isochore_mesh_free(mesh);
    isochore_mesh_free(NULL);
}

static void faulty_meshes(void) {
    IsochoreMesh *mesh = NULL;
    const uint32_t beyond[] = {0, 1, 4};
    CHECK(isochore_mesh_new(CORNERS, 4, beyond, 1, &mesh) == ISOCHORE_STATUS_MESH);
    CHECK(strstr(isochore_last_error(), "vertex 4") && mesh == NULL);
    CHECK(isochore_mesh_new(NULL, 4, FACES, 4, &mesh) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_mesh_new(CORNERS, SIZE_MAX, FACES, 4, &mesh) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_mesh_new(CORNERS, 4, FACES, 4, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_mesh_read("absent.obj", &mesh) == ISOCHORE_STATUS_FILE);
    CHECK(strstr(isochore_last_error(), "absent.obj"));
    CHECK(isochore_mesh_read("\xff.obj", &mesh) == ISOCHORE_STATUS_ARGUMENT);

    double volume = 7;
    CHECK(isochore_mesh_new(CORNERS, 4, FACES, 3, &mesh) == ISOCHORE_STATUS_OK);
    CHECK(isochore_mesh_volume(mesh, &volume) == ISOCHORE_STATUS_MESH && volume == 7);
    isochore_mesh_free(mesh);
}

static void recipes(void) {
    IsochoreMesh *mesh = tetrahedron(), *twisted = NULL;
    IsochoreNamedMesh named = {"tetrahedron", mesh};
    char *report = NULL;
    CHECK(isochore_run(TWIST, &named, 1, NULL, NULL, &twisted, &report) == ISOCHORE_STATUS_OK);
    CHECK(strstr(report, "\"volume_change\"") && isochore_mesh_vertex_count(twisted) >= 4);
    isochore_text_free(report);
    isochore_mesh_free(twisted);

    twisted = NULL;
    CHECK(isochore_run(TWIST, NULL, 0, NULL, NULL, &twisted, NULL) == ISOCHORE_STATUS_RECIPE);
    CHECK(strstr(isochore_last_error(), "`tetrahedron` was not passed in") && twisted == NULL);
    CHECK(isochore_run("recipe = 1\n[targe]\n", NULL, 0, NULL, NULL, &twisted, NULL) == ISOCHORE_STATUS_RECIPE);
    CHECK(strstr(isochore_last_error(), "line 2"));
    CHECK(isochore_run(NULL, NULL, 0, NULL, NULL, &twisted, NULL) == ISOCHORE_STATUS_ARGUMENT);

    int updates = 0;
    CHECK(isochore_run(TWIST, &named, 1, stop, &updates, &twisted, NULL) == ISOCHORE_STATUS_CANCELLED);
    CHECK(updates > 0 && twisted == NULL);
    isochore_mesh_free(mesh);
}

/* A recipe that moves material along a spine, except at vertex 1. The arguments are the target, the spine and the mask. */
#define MASKED_STRIP                                                                             \
    "{ \"recipe\": 1, \"target\": { \"mesh\": \"%s\" }, \"refine\": { \"enabled\": false },"     \
    " \"mask\": { \"vertices\": %s, \"fade\": 0.1 }, \"output\": { \"mesh\": \"output.obj\" },"  \
    " \"stroke\": [ { \"kind\": \"strip\", \"mode\": \"along\", \"spine\": %s, \"radius\": 0.2," \
    " \"support\": 0.3, \"distance\": 0.2 } ] }"

/* Path of the file `name` in `folder`, in a buffer that the next call overwrites. */
static const char *in(const char *folder, const char *name) {
    static char path[4096];
    CHECK(snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path);
    return path;
}

static void write_text(const char *path, const char *content) {
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(content, file) >= 0 && fclose(file) == 0);
}

/* Runs a recipe file that names a mesh, a spine and weights in its folder. The result equals that of the same recipe with the
   contents of the files. Messages about faulty files name the file and the key. */
static void recipe_files(void) {
    char folder[] = "/tmp/isochore-XXXXXX", inlined[1024], named_files[1024];
    CHECK(mkdtemp(folder));
    snprintf(named_files, sizeof named_files, MASKED_STRIP, "target.obj", "\"weights.csv\"", "\"spine.csv\"");
    snprintf(inlined, sizeof inlined, MASKED_STRIP, "target.obj", "[0, 1, 0, 0]", "[[-1, 0, 0], [1, 0, 0]]");
    IsochoreMesh *target = tetrahedron(), *expected = NULL, *deformed = NULL;
    IsochoreNamedMesh named = {"target.obj", target};
    CHECK(isochore_run(inlined, &named, 1, NULL, NULL, &expected, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_mesh_write(target, in(folder, "target.obj")) == ISOCHORE_STATUS_OK);
    write_text(in(folder, "recipe.json"), named_files);
    write_text(in(folder, "weights.csv"), "weight\n0\n1\n0\n0\n");

    CHECK(isochore_run_file(in(folder, "recipe.json"), NULL, NULL, &deformed, NULL) == ISOCHORE_STATUS_FILE);
    CHECK(deformed == NULL && strstr(isochore_last_error(), "stroke.0.spine: "));
    CHECK(strstr(isochore_last_error(), in(folder, "spine.csv")));
    write_text(in(folder, "spine.csv"), "x,y,z\n-1,0,0\n1,0\n");
    CHECK(isochore_run_file(in(folder, "recipe.json"), NULL, NULL, &deformed, NULL) == ISOCHORE_STATUS_RECIPE);
    CHECK(strstr(isochore_last_error(), "spine.csv: row 3 has 2 columns"));
    write_text(in(folder, "spine.csv"), "x,y,z\n-1,0,0\n1,0,0\n");

    char *report = NULL;
    CHECK(isochore_run_file(in(folder, "recipe.json"), NULL, NULL, &deformed, &report) == ISOCHORE_STATUS_OK);
    size_t count = isochore_mesh_vertex_count(expected);
    const double *positions = isochore_mesh_positions(deformed);
    CHECK(isochore_mesh_vertex_count(deformed) == count);
    CHECK(memcmp(positions, isochore_mesh_positions(expected), 3 * count * sizeof(double)) == 0);
    CHECK(memcmp(positions + 3, CORNERS + 3, 3 * sizeof(double)) == 0);
    CHECK(memcmp(positions, CORNERS, 3 * sizeof(double)) != 0);
    CHECK(strstr(report, "\"volume_change\"") && access(in(folder, "output.obj"), F_OK) != 0);
    isochore_text_free(report);
    isochore_mesh_free(deformed);

    int updates = 0;
    deformed = NULL;
    CHECK(isochore_run_file(in(folder, "recipe.json"), stop, &updates, &deformed, NULL) == ISOCHORE_STATUS_CANCELLED);
    CHECK(updates > 0 && deformed == NULL);
    CHECK(isochore_run_file(in(folder, "recipe.json"), NULL, NULL, NULL, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_run_file(NULL, NULL, NULL, &deformed, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_run_file(in(folder, "absent.toml"), NULL, NULL, &deformed, NULL) == ISOCHORE_STATUS_FILE);
    CHECK(strstr(isochore_last_error(), "absent.toml: cannot read: "));
    write_text(in(folder, "recipe.json"), "{ \"recipe\": 1,\n \"targe\": {} }");
    CHECK(isochore_run_file(in(folder, "recipe.json"), NULL, NULL, &deformed, NULL) == ISOCHORE_STATUS_RECIPE);
    CHECK(strstr(isochore_last_error(), in(folder, "recipe.json: ")) == isochore_last_error());

    const char *const names[] = {"recipe.json", "target.obj", "weights.csv", "spine.csv"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        CHECK(remove(in(folder, names[i])) == 0);
    }
    CHECK(rmdir(folder) == 0);
    isochore_mesh_free(expected);
    isochore_mesh_free(target);
}

/* A twist of 10 degrees per unit rotates a point 9 units along the axis by 90 degrees. Points on the axis stay. No mesh is needed. */
static void points(void) {
    double advected[] = {1, 0, 0, 1, 0, 9, 0, 0, 3}, faulty[] = {0, 0, 0, 0, 0, NAN};
    char *warnings = NULL;
    int updates = 0;
    CHECK(isochore_run_points(TWIST, NULL, 0, NULL, NULL, advected, 3, &warnings) == ISOCHORE_STATUS_OK);
    CHECK(advected[0] == 1 && advected[1] == 0 && advected[2] == 0);
    CHECK(fabs(advected[3]) < 1e-15 && fabs(advected[4] - 1) < 1e-15 && advected[5] == 9);
    CHECK(advected[6] == 0 && advected[7] == 0 && advected[8] == 3);
    CHECK(strstr(warnings, "[\"the lock was skipped: points enclose no volume") == warnings);
    isochore_text_free(warnings);

    CHECK(isochore_run_points(TWIST, NULL, 0, NULL, NULL, NULL, 0, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_run_points(TWIST, NULL, 0, NULL, NULL, NULL, 1, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_run_points(TWIST, NULL, 0, NULL, NULL, advected, SIZE_MAX / 2, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_run_points(TWIST, NULL, 0, NULL, NULL, faulty, 2, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strstr(isochore_last_error(), "element 1"));
    CHECK(isochore_run_points(TWIST, NULL, 0, stop, &updates, advected, 3, NULL) == ISOCHORE_STATUS_CANCELLED);
    CHECK(updates > 0 && advected[0] == 1 && advected[5] == 9);
}

static void sessions(void) {
    const double start[] = {0, 0, 2}, end[] = {0.2, 0, 1}, down[] = {0, 0, -1}, above[] = {0.2, 0.2, 5}, nowhere[] = {NAN, 0, 0}, axis[] = {0, 0, 0, 90};
    IsochoreMesh *mesh = tetrahedron(), *moved = NULL, *again = NULL, *back = NULL;
    IsochoreTool *tool = NULL;
    IsochoreSession *session = NULL;
    IsochoreMoveReceipt move;
    IsochoreStrokeReceipt receipt;
    IsochoreBuffers buffers;
    IsochoreHistory history;
    const IsochoreRange *ranges = NULL;
    IsochoreHit hit;
    size_t count = 0;
    bool done = false;
    double volume = 0;
    char *log = NULL;

    CHECK(isochore_tool_new("ball", "{\"support\": 1}", NULL, 0, NULL, NULL, &tool) == ISOCHORE_STATUS_RECIPE);
    CHECK(strstr(isochore_last_error(), "shape") && tool == NULL);
    CHECK(isochore_tool_new("ball", "{\"shape\": {\"kind\": \"sphere\", \"radius\": 0.3}, \"support\": 1}", NULL, 0, NULL, NULL,
                            &tool) == ISOCHORE_STATUS_OK);
    IsochoreSessionOptions options;
    memset(&options, 0, sizeof options);
    options.unlocked = true;
    options.angle_normals = true;
    CHECK(isochore_session_new(mesh, &options, &session) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_take_changes(session) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_changed(session, ISOCHORE_BUFFER_INDICES, &ranges, &count) == ISOCHORE_STATUS_OK);
    CHECK(count == 1 && ranges[0].start == 0 && ranges[0].end == 4);
    CHECK(isochore_session_changed(session, 4, &ranges, &count) == ISOCHORE_STATUS_ARGUMENT);

    CHECK(isochore_session_end_stroke(session, NULL) == ISOCHORE_STATUS_STATE);
    CHECK(isochore_session_begin_stroke(session, tool, &UNREFINED) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_undo(session, &done) == ISOCHORE_STATUS_STATE);
    CHECK(isochore_session_move_to(session, nowhere, NULL, 0, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_move_to(session, start, axis, 0, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strstr(isochore_last_error(), "rotate") != NULL);
    CHECK(isochore_session_move_to(session, start, NULL, 0, &move) == ISOCHORE_STATUS_OK);
    CHECK(move.moved_vertices == 0);
    CHECK(isochore_session_move_to(session, end, NULL, 1, &move) == ISOCHORE_STATUS_OK);
    CHECK(move.moved_vertices > 0 && move.inserted_vertices == 0 && !move.is_stopped);
    CHECK(!move.is_limited && move.refused_splits == 0);
    CHECK(isochore_session_end_stroke(session, &receipt) == ISOCHORE_STATUS_OK);
    CHECK(receipt.moves == 1 && receipt.touched_vertices == move.moved_vertices && receipt.has_volume);
    CHECK(receipt.lock_skipped == ISOCHORE_LOCK_SKIPPED_OFF && receipt.lock_max_shift == 0);
    CHECK(isochore_session_history(session, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_history(session, &history) == ISOCHORE_STATUS_OK);
    CHECK(history.undoable == 1 && history.redoable == 0 && history.forgotten == 0 && history.bytes == receipt.undo_bytes);
    CHECK(isochore_session_volume(session, &volume) == ISOCHORE_STATUS_OK);
    CHECK(fabs(volume - 1.0 / 6 - receipt.volume_flow) < 1e-14);
    CHECK(isochore_session_buffers(session, &buffers) == ISOCHORE_STATUS_OK);
    CHECK(buffers.vertex_count == 4 && buffers.triangle_count == 4 && buffers.colors == NULL);
    CHECK(buffers.positions[11] != 1);
    CHECK(isochore_session_pick(session, above, down, &hit, &done) == ISOCHORE_STATUS_OK && done && hit.distance > 3);
    CHECK(fabs(hit.weights[0] + hit.weights[1] + hit.weights[2] - 1) < 1e-15);
    CHECK(isochore_session_closest_point(session, above, &hit, &done) == ISOCHORE_STATUS_OK && done);

    /* Replaying the log on the same mesh gives the same bits. */
    CHECK(isochore_session_log(session, &log) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_export(session, false, &moved) == ISOCHORE_STATUS_OK);
    char *recipe = (char *)malloc(strlen(log) + 64);
    sprintf(recipe, "{ \"refine\": { \"enabled\": false },%s", strchr(log, '{') + 1);
    IsochoreNamedMesh named = {"target", mesh};
    CHECK(isochore_run(recipe, &named, 1, NULL, NULL, &again, NULL) == ISOCHORE_STATUS_OK);
    CHECK(memcmp(isochore_mesh_positions(moved), isochore_mesh_positions(again), sizeof CORNERS) == 0);
    free(recipe);

    CHECK(isochore_session_undo(session, &done) == ISOCHORE_STATUS_OK && done);
    CHECK(isochore_session_export(session, false, &back) == ISOCHORE_STATUS_OK);
    CHECK(memcmp(isochore_mesh_positions(back), CORNERS, sizeof CORNERS) == 0);
    CHECK(isochore_session_redo(session, &done) == ISOCHORE_STATUS_OK && done);
    CHECK(isochore_session_redo(session, NULL) == ISOCHORE_STATUS_OK);

    isochore_text_free(log);
    isochore_mesh_free(back);
    isochore_mesh_free(again);
    isochore_mesh_free(moved);
    isochore_session_free(session);
    isochore_tool_free(tool);
    isochore_mesh_free(mesh);
}

/* Queries that a host uses for drawing. The session remains valid after its mesh and its tool are freed. */
static void queries(void) {
    const double above[] = {0.2, 0.2, 0.5}, below[] = {0.2, 0.2, 0.3}, turn[] = {0, 0, 1, 90}, small_turn[] = {0, 0, 1, 20}, nowhere[] = {NAN, 0, 0};
    IsochoreMesh *mesh = tetrahedron();
    IsochoreTool *tool = NULL;
    IsochoreSession *session = NULL;
    IsochoreOrigin origin;
    IsochoreMoveReceipt move;
    IsochoreStrokeReceipt receipt;
    const uint32_t *vertices = NULL;
    const IsochoreArrow *arrows = NULL;
    size_t count = 9, rim = 0;
    double outward = 0, inward = 0;

    CHECK(isochore_tool_new("ball", BALL, NULL, 0, NULL, NULL, &tool) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_new(mesh, NULL, &session) == ISOCHORE_STATUS_OK);
    isochore_mesh_free(mesh);

    /* Only the corners (0, 0, 0) and (0, 0, 1), both at distance 0.57, are within 0.6. */
    CHECK(isochore_session_vertices_in_reach(session, tool, above, turn, &vertices, &count) == ISOCHORE_STATUS_OK);
    CHECK(count == 2 && vertices[0] == 0 && vertices[1] == 3);
    CHECK(isochore_session_vertices_in_reach(session, tool, nowhere, NULL, &vertices, &count) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_session_vertices_in_reach(session, NULL, above, NULL, &vertices, &count) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(count == 2 && vertices[1] == 3);

    CHECK(isochore_session_preview(session, tool, above, NULL, below, turn, 9, &arrows, &count) == ISOCHORE_STATUS_OK);
    CHECK(count > 100 && count < 9 * 9 * 9);
    for (size_t i = 0; i < count; i++) {
        double x = arrows[i].point[0] - 0.2, y = arrows[i].point[1] - 0.2, z = arrows[i].point[2] - 0.5;
        /* Points in the core of the ball move with it, also if it rotates. */
        CHECK(x * x + y * y + z * z > 0.001 || fabs(arrows[i].shift[2] + 0.2) < 1e-6);
        CHECK(x * x + y * y + z * z < 0.8 * 0.8);
        rim += fabs(arrows[i].shift[2]) < 0.1;
    }
    CHECK(rim > 0);
    CHECK(isochore_session_preview(session, tool, above, NULL, nowhere, NULL, 9, &arrows, &count) == ISOCHORE_STATUS_ARGUMENT);

    CHECK(isochore_session_origin(session, 3, &origin) == ISOCHORE_STATUS_OK);
    CHECK(origin.vertex == 3 && origin.triangle < 4);
    CHECK(origin.weights[0] + origin.weights[1] + origin.weights[2] == 1);
    CHECK(isochore_session_origin(session, 4, &origin) == ISOCHORE_STATUS_ARGUMENT);

    CHECK(isochore_session_moved_volume(session, &outward, &inward) == ISOCHORE_STATUS_OK && outward == 0 && inward == 0);
    CHECK(isochore_session_begin_stroke(session, tool, &FINE) == ISOCHORE_STATUS_OK);
    isochore_tool_free(tool);
    CHECK(isochore_session_move_to(session, above, NULL, 0, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_move_to(session, below, small_turn, 1, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_moved_volume(session, &outward, &inward) == ISOCHORE_STATUS_OK && outward > 0 && inward > 0);
    CHECK(isochore_session_cancel_stroke(session) == ISOCHORE_STATUS_OK);

    /* A kept ball around everything, or an exhausted triangle limit, prevents all splits. */
    const double around[] = {0, 0, 0, 3};
    IsochoreStrokeOptions strokes[] = {{false, 0.2, 0, around, 1, 0}, {false, 0.2, 4, NULL, 0, 0}, FINE};
    for (int stroke = 0; stroke < 3; stroke++) {
        CHECK(isochore_tool_new("ball", BALL, NULL, 0, NULL, NULL, &tool) == ISOCHORE_STATUS_OK);
        CHECK(isochore_session_begin_stroke(session, tool, &strokes[stroke]) == ISOCHORE_STATUS_OK);
        CHECK(isochore_session_move_to(session, above, NULL, 0, NULL) == ISOCHORE_STATUS_OK);
        CHECK(isochore_session_move_to(session, below, NULL, 1, &move) == ISOCHORE_STATUS_OK);
        CHECK(isochore_session_end_stroke(session, &receipt) == ISOCHORE_STATUS_OK);
        CHECK((move.inserted_vertices > 0) == (stroke == 2));
        CHECK(move.is_limited == (stroke == 1));
        CHECK(receipt.inserted_vertices >= move.inserted_vertices && receipt.is_limited == move.is_limited);
        CHECK(receipt.crossings == 0 && !receipt.is_stopped && receipt.stopped_at == 1);
        CHECK(receipt.lock_skipped == ISOCHORE_LOCK_SKIPPED_NO && receipt.lock_max_shift > 0);
        isochore_tool_free(tool);
    }
    CHECK(isochore_session_vertices(session, &vertices, &count) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_export(session, false, &mesh) == ISOCHORE_STATUS_OK);
    CHECK(count == isochore_mesh_vertex_count(mesh) && count == 4 + receipt.inserted_vertices - receipt.removed_vertices);
    for (size_t i = 1; i < count; i++) CHECK(vertices[i - 1] < vertices[i]);
    const uint32_t *map = NULL;
    size_t opened = 0, matches = 0;
    CHECK(isochore_session_vertex_map(session, &map, &opened) == ISOCHORE_STATUS_OK && opened == 4);
    for (size_t i = 0; i < count; i++) matches += vertices[i] == map[0];
    CHECK(matches == 1);
    isochore_mesh_free(mesh);
    strokes[0].longest_edge = -1;
    CHECK(isochore_session_begin_stroke(session, NULL, &strokes[0]) == ISOCHORE_STATUS_ARGUMENT);
    isochore_session_free(session);
}

static void masks(void) {
    const double start[] = {0.3, 0.3, 0.8}, end[] = {0.3, 0.3, 0.3};
    const double weights[] = {0, 1, 0, 0}, wrong[] = {0, 0, 2, 0};
    const uint32_t vertices[] = {0, 1, 2, 3, 4};
    IsochoreMesh *mesh = tetrahedron(), *moved = NULL;
    IsochoreTool *tool = NULL;
    IsochoreSession *session = NULL;
    IsochoreStrokeReceipt receipt;
    IsochoreSessionOptions options;
    memset(&options, 0, sizeof options);

    options.weights = wrong;
    options.weight_count = 4;
    CHECK(isochore_session_new(mesh, &options, &session) == ISOCHORE_STATUS_MESH && session == NULL);
    CHECK(strstr(isochore_last_error(), "mask.vertices.2"));
    options.weights = weights;
    options.weight_count = 3;
    CHECK(isochore_session_new(mesh, &options, &session) == ISOCHORE_STATUS_MESH);
    CHECK(strstr(isochore_last_error(), "3 weights are given for 4 vertices"));
    options.mask = "{\"pin\": []}";
    CHECK(isochore_session_new(mesh, &options, &session) == ISOCHORE_STATUS_RECIPE);
    CHECK(strstr(isochore_last_error(), "mask") && session == NULL);

    options.weight_count = 4;
    options.mask = "{\"fade\": 0.1}";
    CHECK(isochore_session_new(mesh, &options, &session) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_freeze_edges(session, vertices, 5) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strstr(isochore_last_error(), "vertex 4 is out of range"));
    CHECK(isochore_session_freeze_edges(session, vertices, 4) == ISOCHORE_STATUS_OK);
    CHECK(isochore_tool_new("ball", WIDE_BALL, NULL, 0, NULL, NULL, &tool) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_begin_stroke(session, tool, &FINE) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_move_to(session, start, NULL, 0, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_move_to(session, end, NULL, 1, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_end_stroke(session, &receipt) == ISOCHORE_STATUS_OK && receipt.inserted_vertices == 0);
    CHECK(isochore_session_export(session, false, &moved) == ISOCHORE_STATUS_OK);
    for (size_t vertex = 0; vertex < 4; vertex++) {
        bool is_still = memcmp(isochore_mesh_positions(moved) + 3 * vertex, CORNERS + 3 * vertex, 3 * sizeof(double)) == 0;
        CHECK(is_still == (vertex == 1));
    }
    isochore_mesh_free(moved);
    isochore_session_free(session);
    isochore_tool_free(tool);
    isochore_mesh_free(mesh);
}

/* Presses a ball into one face of a mesh with refinement and returns the result. */
static IsochoreMesh *refined_by_a_press(const IsochoreMesh *mesh, bool lock) {
    const double start[] = {0.3, 0.3, 0.8}, end[] = {0.3, 0.3, 0.3};
    IsochoreMesh *refined = NULL;
    IsochoreTool *tool = NULL;
    IsochoreSession *session = NULL;

    CHECK(isochore_tool_new("ball", WIDE_BALL, NULL, 0, NULL, NULL, &tool) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_new(mesh, NULL, &session) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_begin_stroke(session, tool, &FINE) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_move_to(session, start, NULL, 0, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_move_to(session, end, NULL, 1, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_end_stroke(session, NULL) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_export(session, lock, &refined) == ISOCHORE_STATUS_OK);
    isochore_session_free(session);
    isochore_tool_free(tool);
    return refined;
}

/* Each original vertex has two joints of its own, so an inserted vertex has joints of its neighbors. */
static void skins(void) {
    const uint32_t joints[] = {0, 1, 2, 3, 4, 5, 6, 7};
    const double weights[] = {1, 3, 1, 3, 1, 3, 1, 3}, wrong[] = {1, 3, 1, 3, -1, 3, 1, 3};
    IsochoreMesh *mesh = tetrahedron(), *refined = NULL;

    CHECK(isochore_mesh_skin_influences(mesh) == 0 && isochore_mesh_skin_influences(NULL) == 0);
    CHECK(isochore_mesh_set_skin(mesh, 2, joints, wrong) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strstr(isochore_last_error(), "vertex 2") && isochore_mesh_skin_influences(mesh) == 0);
    CHECK(isochore_mesh_set_skin(mesh, 0, NULL, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_mesh_set_skin(mesh, SIZE_MAX / 2, joints, weights) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_mesh_set_skin(mesh, 2, joints, weights) == ISOCHORE_STATUS_OK);

    refined = refined_by_a_press(mesh, false);
    size_t count = isochore_mesh_vertex_count(refined), each = isochore_mesh_skin_influences(refined);
    CHECK(count > 4 && each == 2);
    uint32_t *found_joints = (uint32_t *)malloc(count * each * sizeof *found_joints);
    double *found_weights = (double *)malloc(count * each * sizeof *found_weights);
    CHECK(isochore_mesh_skin(refined, found_joints, NULL) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(isochore_mesh_skin(refined, found_joints, found_weights) == ISOCHORE_STATUS_OK);
    for (size_t vertex = 0; vertex < count; vertex++) {
        CHECK(fabs(found_weights[2 * vertex] + found_weights[2 * vertex + 1] - 1) < 1e-15);
        CHECK(found_joints[2 * vertex] < 8 && found_joints[2 * vertex + 1] < 8);
        CHECK(vertex >= 4 || (found_joints[2 * vertex] == 2 * vertex && found_weights[2 * vertex] == 0.25));
    }
    free(found_joints);
    free(found_weights);
    isochore_mesh_free(refined);
    isochore_mesh_free(mesh);
}

/* Attributes set by a host pass through a session and are written to files. */
static void attributes(const char *path) {
    const uint32_t triangle_materials[] = {0, 1, 0, 1}, wrong[] = {0, 1, 0, 2};
    const char *const names[] = {"clay", "glaze"};
    double colors[16];
    float uvs[24], normals[36];
    for (int i = 0; i < 24; i++) uvs[i] = i / 24.0f;
    for (int i = 0; i < 16; i++) colors[i] = i / 16.0;
    for (int i = 0; i < 36; i++) normals[i] = i % 3 == 2;
    IsochoreMesh *mesh = tetrahedron(), *refined = NULL;
    IsochoreSession *session = NULL;
    IsochoreBuffers buffers;
    const double *found = NULL;
    const float *coordinates = NULL, *directions = NULL;
    const uint32_t *materials = NULL;
    char *name = NULL;
    size_t count = 1;

    CHECK(isochore_mesh_uvs(mesh, 0, &coordinates, &count) == ISOCHORE_STATUS_OK && count == 0);
    CHECK(isochore_mesh_set_uvs(mesh, 1, uvs) == ISOCHORE_STATUS_ARGUMENT);
    uvs[7] = NAN;
    CHECK(isochore_mesh_set_uvs(mesh, 0, uvs) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strstr(isochore_last_error(), "element 1"));
    uvs[7] = 0.5f;
    CHECK(isochore_mesh_set_uvs(mesh, 0, uvs) == ISOCHORE_STATUS_OK);
    CHECK(isochore_mesh_set_uvs(mesh, 1, uvs) == ISOCHORE_STATUS_OK);
    CHECK(isochore_mesh_set_normals(mesh, NULL) == ISOCHORE_STATUS_ARGUMENT);
    normals[11] = 0;
    CHECK(isochore_mesh_set_normals(mesh, normals) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strstr(isochore_last_error(), "triangle 1"));
    normals[11] = 1;
    CHECK(isochore_mesh_set_normals(mesh, normals) == ISOCHORE_STATUS_OK);
    CHECK(isochore_mesh_set_vertex_colors(mesh, colors) == ISOCHORE_STATUS_OK);
    CHECK(isochore_mesh_set_materials(mesh, wrong, names, 2) == ISOCHORE_STATUS_ARGUMENT);
    CHECK(strstr(isochore_last_error(), "triangle 3"));
    CHECK(isochore_mesh_set_materials(mesh, triangle_materials, names, 2) == ISOCHORE_STATUS_OK);

    CHECK(isochore_mesh_uvs(mesh, 1, &coordinates, &count) == ISOCHORE_STATUS_OK);
    CHECK(count == 24 && memcmp(coordinates, uvs, sizeof uvs) == 0);
    CHECK(isochore_mesh_normals(mesh, &directions, &count) == ISOCHORE_STATUS_OK);
    CHECK(count == 36 && memcmp(directions, normals, sizeof normals) == 0);
    CHECK(isochore_mesh_vertex_colors(mesh, &found, &count) == ISOCHORE_STATUS_OK);
    CHECK(count == 16 && memcmp(found, colors, sizeof colors) == 0);
    CHECK(isochore_mesh_material_name(mesh, 2, &name) == ISOCHORE_STATUS_ARGUMENT);

    CHECK(isochore_session_new(mesh, NULL, &session) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_buffers(session, &buffers) == ISOCHORE_STATUS_OK);
    CHECK(isochore_session_uvs(session, 2, &coordinates, &count) == ISOCHORE_STATUS_OK && count == 0);
    CHECK(isochore_session_uvs(session, 1, &coordinates, &count) == ISOCHORE_STATUS_OK);
    CHECK(count == 2 * buffers.vertex_count && buffers.triangle_count == 4);
    for (int i = 0; i < 12; i++) CHECK(memcmp(coordinates + 2 * buffers.indices[i], uvs + 2 * i, 2 * sizeof *uvs) == 0);
    isochore_session_free(session);

    refined = refined_by_a_press(mesh, true);
    CHECK(isochore_mesh_write(refined, path) == ISOCHORE_STATUS_OK);
    isochore_mesh_free(refined);
    CHECK(isochore_mesh_read(path, &refined) == ISOCHORE_STATUS_OK);
    size_t triangles = isochore_mesh_triangle_count(refined);
    CHECK(triangles > 4);
    CHECK(isochore_mesh_uvs(refined, 0, &coordinates, &count) == ISOCHORE_STATUS_OK && count == 6 * triangles);
    for (size_t i = 0; i < count; i++) CHECK(coordinates[i] >= 0 && coordinates[i] <= 1);
    CHECK(isochore_mesh_triangle_materials(refined, &materials, &count) == ISOCHORE_STATUS_OK && count == triangles);
    for (size_t i = 0; i < count; i++) CHECK(materials[i] < 2);
    CHECK(isochore_mesh_material_name(refined, materials[0], &name) == ISOCHORE_STATUS_OK);
    CHECK(strcmp(name, "clay") == 0 || strcmp(name, "glaze") == 0);
    isochore_text_free(name);
    isochore_mesh_free(refined);
    isochore_mesh_free(mesh);
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    meshes(arguments[1]);
    faulty_meshes();
    recipes();
    recipe_files();
    points();
    sessions();
    queries();
    masks();
    skins();
    attributes(arguments[1]);
    return 0;
}
