/* scene-print SCENE [MESHES [MOTION]]: loads a scene and writes what it holds, for gltf.py and
 * scenes.py: a line of JSON with the messages and counts, then the arrays as they lie in memory.
 * With a motion all of its frames, and one behind the last. */
#include <cjson/cJSON.h>
#include <stdio.h>

#include "motion.h"
#include "scene.h"

static void hear(void *user, enum dt_level level, const char *message)
{
    static const char *const names[] = {
        [DT_DEBUG] = "debug", [DT_INFO] = "info", [DT_WARNING] = "warning", [DT_ERROR] = "error"};
    cJSON *entry = cJSON_CreateArray();
    cJSON_AddItemToArray(entry, cJSON_CreateString(names[level]));
    cJSON_AddItemToArray(entry, cJSON_CreateString(message));
    cJSON_AddItemToArray(user, entry);
}

static void write_array(const void *items, size_t count, size_t size)
{
    if (count)
        fwrite(items, size, count, stdout);
}

int main(int count, char **words)
{
    struct scene scene = {0};
    cJSON *root = cJSON_CreateObject();
    const struct dt_log log = {hear, cJSON_AddArrayToObject(root, "messages")};
    if (count < 2 || count > 4)
        return 2;
    bool loaded = scene_load(&scene, words[1], count > 2 ? words[2] : NULL, false, &log);
    uint32_t frames = loaded;
    if (count > 3)
        frames = loaded && scene_load_motion(&scene, words[3], &log)
                     ? motion_frames(scene.motion) + 1
                     : 0;
    const struct dt_scene *data = &scene.data;
    const struct {
        const char *name;
        uint32_t number;
    } numbers[] = {{"loaded", loaded},
                   {"vertices", data->vertex_count},
                   {"indices", data->index_count},
                   {"materials", data->material_count},
                   {"objects", data->object_count},
                   {"frames", frames},
                   {"width", data->texture_width},
                   {"height", data->texture_height},
                   {"layers", data->texture_layers},
                   {"mips", data->texture_mips},
                   {"source", scene.source_triangles},
                   {"degenerate", scene.degenerate_triangles}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(numbers); i++)
        cJSON_AddNumberToObject(root, numbers[i].name, numbers[i].number);
    char *text = cJSON_PrintUnformatted(root);
    puts(text);
    write_array(data->vertices, data->vertex_count, sizeof *data->vertices);
    write_array(data->indices, data->index_count, sizeof *data->indices);
    write_array(data->materials, data->material_count, sizeof *data->materials);
    write_array(data->objects, data->object_count, sizeof *data->objects);
    for (uint32_t i = 0; i < frames; i++) {
        struct dt_frame frame;
        scene_frame_at(&scene, i, 200, 100, &frame);
        write_array(&frame, 1, sizeof frame);
    }
    write_array(data->texels, loaded ? scene_texel_bytes(data) : 0, 1);
    write_array(&scene.camera, 1, sizeof scene.camera);
    write_array(scene.bounds_min, 3, sizeof(float));
    write_array(scene.bounds_max, 3, sizeof(float));
    cJSON_free(text);
    cJSON_Delete(root);
    scene_free(&scene);
    return 0;
}
