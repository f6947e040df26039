/* Inputs that fuzz.c feeds to gen/: specs, bodies, entries of the shader cache. */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"
#include "gen/load.h"
#include "gen/print/print.h"
#include "gen/spirv/watchdog.h"
#include "gen/spirv/shader_cache.h"

static void load_spec(const char *name)
{
    char path[256];
    fuzz_path(path, name);
    const struct spec_request request = {.path = path, .templates = fuzz_templates, .text = true};
    struct spec spec = {0};
    struct diag *diag = diag_create();
    struct text text = {0};
    watchdog_start(10, 1);
    bool good = spec_load(&spec, &request, true, diag);
    watchdog_stop();
    fuzz_insist(good != (diag_error_count(diag) > 0), "a spec is wrong without a message");
    if (good) {
        emit_header(&spec.model, &text);
        emit_c_panel(spec.tables, &text);
        emit_c_shaders(spec.tables, BACKEND_GL, false, true, &text);
        emit_c_shaders(spec.tables, BACKEND_VK, true, false, &text);
    }
    diag_json(diag, &text);
    diag_print(diag, "diptych-gen", stderr);
    fuzz_insist(!text.failed, "a text cannot be written");
    text_free(&text);
    diag_free(diag);
    spec_free(&spec);
}

static const char pass_of_body[] =
    "pipeline: fuzz\n"
    "params: {steps: 3, gain: {value: 0.5, min: 0, max: 1, live: true}}\n"
    "structs: {Cell: {count: uint, color: vec3}}\n"
    "buffers: {cells: {of: Cell, count: frame.width}}\n"
    "images: {picture: {format: rgba16f, size: frame}, seen: {format: r32f, size: frame}}\n"
    "passes:\n"
    "  - {name: fill, dispatch: picture, writes: [seen, cells], shader: fill.glsl}\n"
    "  - {name: use, dispatch: picture, reads: [seen, cells], writes: [picture], shader: "
    "body.glsl}\n"
    "output: {display: picture}\n";
static const char body_before[] = "void main() { ivec2 p = ivec2(invocation().xy); seen_store(p, "
                                  "vec4(1.0)); if (p.y == 0) cells[p.x].count = 1u; }\n";

void fuzz_spec(const char *bytes, size_t size)
{
    fuzz_put("spec.yaml", bytes, size);
    fuzz_put("fill.glsl", body_before, strlen(body_before));
    load_spec("spec.yaml");
}

void fuzz_body(const char *bytes, size_t size)
{
    fuzz_put("spec.yaml", pass_of_body, strlen(pass_of_body));
    fuzz_put("fill.glsl", body_before, strlen(body_before));
    fuzz_put("body.glsl", bytes, size);
    load_spec("spec.yaml");
}

/* A cache entry that another process left damaged. It must be a miss, or give the words that were
 * written. */
void fuzz_cache(const char *bytes, size_t size)
{
    static uint32_t words[] = {0x07230203, 0x00010000, 0, 1, 0};
    struct shader shader = {.stage = STAGE_IS_COMPUTE, .words = words, .word_count = 5},
                  found = {0};
    struct diag *diag = diag_create();
    text_add(&shader.glsl, "void main() {}\n");
    shader_hash(BACKEND_VK, &shader);
    found = shader;
    found.words = NULL;
    struct cache *cache = cache_open(fuzz_folder, diag);
    fuzz_insist(cache, "the folder is no cache");
    shader_cache_add(cache, &shader);
    DIR *listing = opendir(fuzz_folder);
    char *name = NULL;
    for (struct dirent *entry; listing && !name && (entry = readdir(listing));)
        name = strstr(entry->d_name, ".spv") ? strdup(entry->d_name) : NULL;
    fuzz_insist(listing && name, "the cache has no entry");
    if (listing)
        closedir(listing);
    fuzz_put(name, bytes, size);
    if (shader_cache_find(cache, &found))
        fuzz_insist(found.word_count == shader.word_count &&
                        !memcmp(found.words, words, sizeof words),
                    "a damaged entry is taken");
    free(found.words);
    free(name);
    cache_close(cache);
    text_free(&shader.glsl);
    diag_free(diag);
}
