/* What crosses the border to C: arrays in and out, errors with their words, cancellation. The argument is a file to write. */

#include <isochore.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                       \
    do {                                                                                       \
        if (!(condition)) {                                                                    \
            fprintf(stderr, "%s:%d: %s (%s)\n", __FILE__, __LINE__, #condition, isochore_last_error()); \
            exit(1);                                                                           \
        }                                                                                      \
    } while (0)

static const double CORNERS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t FACES[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

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
    CHECK(strstr(isochore_last_error(), "`tetrahedron` was not loaded") && twisted == NULL);
    CHECK(isochore_run("recipe = 1\n[targe]\n", NULL, 0, NULL, NULL, &twisted, NULL) == ISOCHORE_STATUS_RECIPE);
    CHECK(strstr(isochore_last_error(), "line 2"));
    CHECK(isochore_run(NULL, NULL, 0, NULL, NULL, &twisted, NULL) == ISOCHORE_STATUS_ARGUMENT);

    int heard = 0;
    CHECK(isochore_run(TWIST, &named, 1, stop, &heard, &twisted, NULL) == ISOCHORE_STATUS_CANCELLED);
    CHECK(heard > 0 && twisted == NULL);
    isochore_mesh_free(mesh);
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    meshes(arguments[1]);
    faulty_meshes();
    recipes();
    return 0;
}
