/* Splits the long edges of a mesh, so that projections which bend straight lines (paraboloid maps)
 * can be done per vertex. Called by scene.c. Each round adds a middle to every edge that is too
 * long, and cuts every triangle by the middles of its own edges. */
#include "mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_ROUNDS = 32 };

/* Vertex in the middle of the edge (a, b), a < b; open addressing, empty where vertex is
 * UINT32_MAX. */
struct edge {
    uint32_t a, b, vertex;
};

struct round {
    struct mesh *mesh;
    double limit; /* square of the longest edge allowed */
    struct edge *edges;
    uint32_t slot_mask;
    uint32_t *indices; /* the triangles after this round */
    uint32_t index_count;
};

/* Same bits for (a, b) and (b, a), and for other vertices at the same positions, so that neighbours
 * agree. */
static double edge_square(const struct mesh *mesh, uint32_t a, uint32_t b)
{
    const float *p = mesh->vertices[a].position, *q = mesh->vertices[b].position;
    double x = (double)p[0] - q[0], y = (double)p[1] - q[1], z = (double)p[2] - q[2];
    return x * x + y * y + z * z;
}

/* How many triangles the next round makes, and how many edges it splits at most. */
static uint64_t count_round(const struct mesh *mesh, double limit, uint64_t *splits)
{
    uint64_t triangles = 0;
    *splits = 0;
    for (uint32_t i = 0; i < mesh->index_count; i += 3) {
        uint32_t parts = 1;
        for (int k = 0; k < 3; k++)
            parts +=
                edge_square(mesh, mesh->indices[i + k], mesh->indices[i + (k + 1) % 3]) > limit;
        triangles += parts;
        *splits += parts - 1;
    }
    return triangles;
}

static struct dt_vertex middle(const struct dt_vertex *a, const struct dt_vertex *b)
{
    struct dt_vertex m = {.material = a->material, .triangle = a->triangle};
    double n[3], square = 0;
    for (int i = 0; i < 3; i++) {
        m.position[i] = 0.5f * a->position[i] + 0.5f * b->position[i];
        n[i] = (double)a->normal[i] + b->normal[i];
        square += n[i] * n[i];
    }
    for (int i = 0; i < 2; i++)
        m.uv[i] = 0.5f * a->uv[i] + 0.5f * b->uv[i];
    for (int i = 0; i < 3; i++) /* opposite normals have no mean */
        m.normal[i] = square > 1e-12 ? (float)(n[i] / sqrt(square)) : a->normal[i];
    return m;
}

/* The middle of the edge if it is too long, else UINT32_MAX. */
static uint32_t split(struct round *round, uint32_t a, uint32_t b)
{
    struct mesh *mesh = round->mesh;
    if (edge_square(mesh, a, b) <= round->limit)
        return UINT32_MAX;
    if (a > b) {
        uint32_t swap = a;
        a = b;
        b = swap;
    }
    uint32_t hash = a * 2654435761u ^ b * 2246822519u;
    uint32_t slot = (hash ^ hash >> 15) & round->slot_mask;
    while (round->edges[slot].vertex != UINT32_MAX &&
           (round->edges[slot].a != a || round->edges[slot].b != b))
        slot = (slot + 1) & round->slot_mask;
    if (round->edges[slot].vertex == UINT32_MAX) {
        round->edges[slot] = (struct edge){a, b, mesh->vertex_count};
        mesh->vertices[mesh->vertex_count++] = middle(&mesh->vertices[a], &mesh->vertices[b]);
    }
    return round->edges[slot].vertex;
}

static void emit(struct round *round, uint32_t a, uint32_t b, uint32_t c)
{
    round->indices[round->index_count++] = a;
    round->indices[round->index_count++] = b;
    round->indices[round->index_count++] = c;
}

/* Cuts one triangle by the middles of its long edges; winding stays. */
static void cut(struct round *round, const uint32_t corner[3])
{
    uint32_t mid[3]; /* mid[k] lies between corner[k] and corner[k + 1] */
    int long_edges = 0;
    for (int k = 0; k < 3; k++) {
        mid[k] = split(round, corner[k], corner[(k + 1) % 3]);
        long_edges += mid[k] != UINT32_MAX;
    }
    /* Rotate the corners so that the long edges come first. */
    int first = 0;
    while (long_edges == 1 && mid[first] == UINT32_MAX)
        first++;
    while (long_edges == 2 && mid[(first + 2) % 3] != UINT32_MAX)
        first++;
    uint32_t a = corner[first % 3], b = corner[(first + 1) % 3], c = corner[(first + 2) % 3];
    uint32_t ab = mid[first % 3], bc = mid[(first + 1) % 3], ca = mid[(first + 2) % 3];
    if (long_edges == 0) {
        emit(round, a, b, c);
    } else if (long_edges == 1) {
        emit(round, a, ab, c);
        emit(round, ab, b, c);
    } else if (long_edges == 2) {
        emit(round, ab, b, bc);
        if (edge_square(round->mesh, a, bc) <=
            edge_square(round->mesh, ab, c)) { /* the shorter diagonal */
            emit(round, a, ab, bc);
            emit(round, a, bc, c);
        } else {
            emit(round, a, ab, c);
            emit(round, ab, bc, c);
        }
    } else {
        emit(round, a, ab, ca);
        emit(round, ab, b, bc);
        emit(round, ca, bc, c);
        emit(round, ab, bc, ca);
    }
}

static bool run_round(struct mesh *mesh, double limit, uint64_t triangles, uint64_t splits)
{
    struct round round = {.mesh = mesh, .limit = limit};
    uint32_t slots = 16;
    while (slots < 2 * splits)
        slots *= 2;
    round.slot_mask = slots - 1;
    round.edges = malloc((size_t)slots * sizeof *round.edges);
    round.indices = malloc(3 * triangles * sizeof *round.indices);
    struct dt_vertex *vertices =
        realloc(mesh->vertices, (mesh->vertex_count + splits) * sizeof *vertices);
    if (vertices)
        mesh->vertices = vertices;
    if (!round.edges || !round.indices || !vertices) {
        free(round.edges);
        free(round.indices);
        return false;
    }
    memset(round.edges, 0xff, (size_t)slots * sizeof *round.edges);
    for (uint32_t i = 0; i < mesh->index_count; i += 3)
        cut(&round, &mesh->indices[i]);
    free(mesh->indices);
    free(round.edges);
    mesh->indices = round.indices;
    mesh->index_count = round.index_count;
    return true;
}

static double longest_edge_of(const struct mesh *mesh)
{
    double longest = 0;
    for (uint32_t i = 0; i < mesh->index_count; i++) {
        uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
        longest = fmax(longest, edge_square(mesh, mesh->indices[i], mesh->indices[next]));
    }
    return sqrt(longest);
}

bool mesh_subdivide(struct mesh *mesh, float longest_edge, uint32_t triangle_limit,
                    const struct dt_log *log)
{
    double limit = (double)longest_edge * longest_edge;
    for (int i = 0; i <= MAX_ROUNDS; i++) {
        uint64_t splits, triangles = count_round(mesh, limit, &splits);
        if (splits == 0)
            return true;
        if (triangles > triangle_limit || i == MAX_ROUNDS) {
            log_message(log, DT_WARNING,
                        "subdivision stopped at %u triangles (limit %u): edges up to %g remain, %g "
                        "were asked for; "
                        "raise `subdivide` in the scene file",
                        mesh->index_count / 3, triangle_limit, longest_edge_of(mesh), longest_edge);
            return true;
        }
        if (!run_round(mesh, limit, triangles, splits)) {
            log_message(
                log, DT_ERROR,
                "out of memory while subdividing the mesh; raise `subdivide` in the scene file");
            return false;
        }
    }
    return true;
}
