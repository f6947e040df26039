/* Numbers of triangles, for the import of meshes and for other programs. */
#include "diptych_scene.h"

#include <string.h>

/* A vertex is free until a triangle begins with it; until then triangles[] has its last triangle.
 * Of the free corners each triangle takes the one that the fewest later triangles can use. */
uint32_t dt_number_triangles(uint32_t *indices, uint32_t index_count, uint32_t vertex_count,
                             uint32_t *triangles, uint32_t *copied)
{
    uint32_t count = vertex_count;
    memset(triangles, 0, vertex_count * sizeof *triangles);
    for (uint32_t i = 0; i < index_count; i++)
        triangles[indices[i]] = i / 3;
    for (uint32_t t = 0; t < index_count / 3; t++) {
        const uint32_t corner[3] = {indices[3 * t], indices[3 * t + 1], indices[3 * t + 2]};
        int first = -1;
        for (int k = 0; k < 3; k++)
            if (triangles[corner[k]] >= t &&
                (first < 0 || triangles[corner[k]] < triangles[corner[first]]))
                first = k;
        for (int k = 0; first > 0 && k < 3; k++)
            indices[3 * t + (uint32_t)k] = corner[(first + k) % 3];
        if (first < 0) {
            copied[count - vertex_count] = corner[0];
            indices[3 * t] = count++;
        }
        triangles[indices[3 * t]] = t;
    }
    return count;
}
