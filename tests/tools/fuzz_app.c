/* Inputs that fuzz.c feeds to scenes/ and app/: scenes, inputs, evidence folders, dumps. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "compare/evidence.h"
#include "fuzz.h"
#include "import/reflect.h"
#include "import/slang.h"
#include "gen/model/spirv_check.h"
#include "result/dump_reader.h"
#include "base/npy.h"
#include "scenes/picture_size.h"
#include "theirs/theirs.h"

/* A scene.yaml with its files, and a motion.yaml or none. A child process reads the mesh. A library
 * may crash there, which is an error with a message. A sanitizer's report about our code is a
 * failure without a message. */
void fuzz_scene(const char *bytes, size_t size)
{
    char path[256];
    struct scene scene = {0};
    if (!fuzz_unpack(bytes, size))
        return;
    fuzz_path(path, "scene.yaml");
    fuzz_messages = 0;
    bool good = scene_load(&scene, path, NULL, true, &fuzz_log);
    fuzz_insist(good || fuzz_messages, "a scene is wrong without a message");
    fuzz_path(path, "motion.yaml");
    if (good && access(path, F_OK) == 0) {
        struct dt_frame frame;
        fuzz_messages = 0;
        fuzz_insist(scene_load_motion(&scene, path, &fuzz_log) || fuzz_messages,
                    "a motion is wrong without a message");
        scene_frame_at(&scene, 7, 64, 32, &frame);
    }
    if (good)
        scene_free(&scene);
}

/* An array or a picture, as for --input. Pictures themselves are read by OpenImageIO, in a child. */
void fuzz_input(const char *bytes, size_t size)
{
    char path[256];
    struct npy array;
    const char *reason = NULL;
    uint32_t width, height;
    fuzz_put("input", bytes, size);
    fuzz_path(path, "input");
    void *numbers = npy_read(path, &array, &reason);
    fuzz_insist(numbers || reason, "an array is refused without a reason");
    static const struct dt_field fields[] = {{.name = "a", .type = DT_TYPE_FLOAT},
                                             {.name = "b", .type = DT_TYPE_UVEC2}};
    if (numbers)
        npy_misfit(&array, fields, DT_ARRAY_COUNT(fields));
    free(numbers);
    const struct theirs theirs = {.folder = fuzz_folder, .log = &fuzz_log};
    struct their_entry entry = {.file = (char *)"input"};
    struct dt_bytes content = {0};
    fuzz_messages = 0;
    fuzz_insist(their_npy(&theirs, &entry, &content) || fuzz_messages,
                "an array of others is refused without a message");
    free(content.data);
    free(entry.fields);
    reason = NULL;
    fuzz_insist(picture_size(path, &width, &height, &reason) ? width && height : reason != NULL,
                "a picture is refused without a reason");
}

static void try_dump(void)
{
    static struct pipeline pipeline;
    static struct console console;
    static struct rows rows;
    struct dump_reader dump;
    if (!pipeline.info) {
        const struct setup setup = {.spec = "tests/specs/mips.yaml", .templates = "templates"};
        console.log = fuzz_log;
        fuzz_insist(pipeline_load(&pipeline, &console, &setup) &&
                        rows_make(&rows, pipeline.info, &fuzz_log),
                    "tests/specs/mips.yaml cannot be loaded");
    }
    fuzz_messages = 0;
    bool good = dump_reader_open(&dump, fuzz_folder, &fuzz_log);
    fuzz_insist(good || fuzz_messages, "a dump is damaged without a message");
    dump.pipeline = pipeline.info;
    dump.size[0] = dump.size[1] = 8;
    for (uint32_t i = 0; good && i < rows.outputs.count; i++) {
        struct dt_bytes bytes;
        fuzz_messages = 0;
        fuzz_insist(dump_reader_read(&dump, &rows.outputs.list[i], false, &bytes) || fuzz_messages,
                    "a dump's row is damaged without a message");
    }
    dump_reader_close(&dump);
}

/* An evidence folder for replay, or a dump for compare --against. */
void fuzz_evidence(const char *bytes, size_t size)
{
    struct console console = {.log = fuzz_log, .keeps = true}; /* the messages of a wrong spec */
    const struct setup setup = {0};
    struct evidence_case evidence;
    if (!fuzz_unpack(bytes, size))
        return;
    fuzz_messages = 0;
    bool good = evidence_read(&evidence, &console, fuzz_folder, &setup);
    evidence_free(&evidence);
    fuzz_insist(good || fuzz_messages || console.kept.length,
                "evidence is damaged without a message");
    text_free(&console.kept);
    try_dump();
}

/* A preset and its shaders, up to what a compiler reads. */
void fuzz_preset(const char *bytes, size_t size)
{
    char path[256];
    struct preset preset;
    struct slang slang;
    if (!fuzz_unpack(bytes, size))
        return;
    fuzz_path(path, "a.slangp");
    fuzz_messages = 0;
    bool good = preset_read(path, &preset, &fuzz_log);
    fuzz_insist(good || fuzz_messages, "a preset is wrong without a message");
    const struct preset_entry *shader = preset_find(&preset, "shader0");
    char *file = shader ? slang_path(shader->file, shader->value) : NULL;
    if (file) {
        fuzz_messages = 0;
        fuzz_insist(slang_read(file, &slang, &fuzz_log) || fuzz_messages,
                    "a shader is wrong without a message");
        slang_free(&slang);
    }
    free(file);
    preset_free(&preset);
}

/* What spirv-val takes, reflection takes. */
void fuzz_module(const char *bytes, size_t size)
{
    struct reflection reflection = {0};
    char *why = NULL;
    uint32_t *words = size >= 20 && size % 4 == 0 ? malloc(size) : NULL;
    if (!words)
        return;
    memcpy(words, bytes, size);
    bool good = spirv_check(words, size / 4, &why);
    fuzz_insist(good || why, "a module is wrong without a reason");
    free(why);
    why = NULL;
    for (int stage = REFLECT_COMPUTE; good && stage <= REFLECT_FRAGMENT; stage++) {
        reflect_module(words, size / 4, stage, &reflection, &why);
        free(why);
        why = NULL;
        reflect_free(&reflection);
    }
    free(words);
}
