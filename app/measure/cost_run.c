/* Asks a driver's compiler about a pipeline, in a child process: the environment that chooses RADV and its
 * chip must not reach our own drivers, and a compiler may crash. The answer comes as JSON. */
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

#include "base/nearest.h"
#include "gen/model/spirv_check.h"
#include "gen/spirv/passes.h"
#include "gen/spirv/turns.h"
#include "measure/cost.h"
#include "runtime_vk/statistics.h"
#include "templates/c/front.h"

/* ---- Chips ----------------------------------------------------------------------------------- */

static const struct cost_chip chips[] = {{"polaris10", "POLARIS10"},
                                         {"vega10", "VEGA10"},
                                         {"navi10", "NAVI10"},
                                         {"navi21", "NAVI21"},
                                         {"gfx1100", "GFX1100|NAVI31"}};

const struct cost_chip *cost_chip(const char *name, size_t length, const struct dt_log *log)
{
    const char *names[DT_ARRAY_COUNT(chips)];
    char word[32], all[128] = "; there are";
    for (size_t i = 0; i < DT_ARRAY_COUNT(chips); i++) {
        names[i] = chips[i].name;
        if (strncasecmp(name, names[i], length) == 0 && !names[i][length])
            return &chips[i];
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s %s", i ? "," : "", names[i]);
    }
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    report_error(log, "--gpu %s: unknown chip%s", word,
                 name_hint('"', word, names, DT_ARRAY_COUNT(chips), all).text);
    return NULL;
}

/* ---- RADV ------------------------------------------------------------------------------------ */

/* The loader's file for RADV; free(). NULL: not installed. */
static char *radv_file(void)
{
    static const char *const patterns[] = {"/etc/vulkan/icd.d/radeon_icd*.json",
                                           "/usr/local/share/vulkan/icd.d/radeon_icd*.json",
                                           "/usr/share/vulkan/icd.d/radeon_icd*.json"};
    glob_t found = {0};
    for (size_t i = 0; i < DT_ARRAY_COUNT(patterns); i++)
        glob(patterns[i], i ? GLOB_APPEND : 0, NULL, &found);
    char *file = found.gl_pathc ? strdup(found.gl_pathv[0]) : NULL;
    globfree(&found);
    return file;
}

bool cost_has_radv(const struct dt_log *log)
{
    char *file = radv_file();
    if (!file)
        report_error(log, "RADV, Mesa's Vulkan driver for AMD, is not installed: there is no "
                          "/usr/share/vulkan/icd.d/radeon_icd*.json; install mesa-vulkan-drivers");
    free(file);
    return file;
}

/* Environment for null hardware of one family. */
static bool choose_radv(const char *family, size_t length)
{
    char *file = radv_file(), name[32];
    snprintf(name, sizeof name, "%.*s", (int)length, family);
    bool good = file && setenv("VK_ICD_FILENAMES", file, 1) == 0 &&
                unsetenv("VK_DRIVER_FILES") == 0 && setenv("RADV_FORCE_FAMILY", name, 1) == 0;
    free(file);
    return good;
}

/* ---- The child ------------------------------------------------------------------------------- */

static void keep_error(void *answer, enum dt_level level, const char *message)
{
    cJSON_DeleteItemFromObject(answer, "error");
    if (level == DT_ERROR)
        cJSON_AddStringToObject(answer, "error", message);
}

static void add_figures(cJSON *to, const char *name, const struct vk_executable *executable)
{
    cJSON *figures = cJSON_AddObjectToObject(to, name);
    for (uint32_t i = 0; i < executable->count; i++)
        cJSON_AddNumberToObject(figures, executable->list[i].name, executable->list[i].value);
}

/* ---- Turns of loops -------------------------------------------------------------------------- */

/* RADV's compiler guesses the turns of loops that it keeps. So a stage with a loop of known turns is compiled again for each of
 * its loops: kept from being unrolled, which tells whether it was; and in a loop of one turn, which weighs it more. */

enum { MOST_LOOPS = 64 }; /* of a stage */

struct child {
    const struct pipeline *pipeline;
    const struct dt_log *log;
    struct vk_asking *asking;
};

/* A stage in those of a pass. */
static struct dt_code *code_of(struct dt_stages *stages, uint32_t stage)
{
    return stage & VK_SHADER_STAGE_COMPUTE_BIT    ? &stages->compute
           : stage & VK_SHADER_STAGE_FRAGMENT_BIT ? &stages->fragment
                                                  : &stages->vertex;
}

/* Adds the figures of a stage that is compiled from that module. */
static bool add_compiled(const struct child *child, cJSON *told, const char *name,
                         const struct vk_executable *plain, const struct spirv *module)
{
    struct dt_stages stages = child->pipeline->vk->stages[plain->pass];
    struct vk_executables found;
    *code_of(&stages, plain->stages) =
        (struct dt_code){.words = module->words, .size = module->count * sizeof *module->words};
    bool good = vk_statistics_ask(child->asking, plain->pass, &stages, &found);
    for (uint32_t i = 0; good && i < found.count; i++)
        if (found.list[i].stages == plain->stages)
            add_figures(told, name, &found.list[i]);
    return good;
}

/* The same with one of its loops kept, or wrapped; nothing, if it cannot be. */
static bool add_changed(const struct child *child, cJSON *told, bool wrapped,
                        const struct vk_executable *plain, const struct spirv *module, size_t merge)
{
    struct spirv changed;
    bool good = spirv_open(&changed, module->words, module->count);
    if (good && spirv_keep_loop(&changed, merge, wrapped))
        good = add_compiled(child, told, wrapped ? "wrapped" : "kept", plain, &changed);
    spirv_free(&changed);
    return good;
}

/* The module of a stage, with functions in place of their calls. */
static bool take_stage(const struct child *child, const struct vk_executable *plain,
                       struct spirv *module)
{
    struct dt_stages stages = child->pipeline->vk->stages[plain->pass];
    const struct dt_code *code = code_of(&stages, plain->stages);
    size_t count = code->size / sizeof *code->words;
    uint32_t *own;
    const uint32_t *words = dt_front_words(code, &own);
    uint32_t *inlined = words ? spirv_optimize(words, &count, SPIRV_INLINE) : NULL;
    free(own);
    return inlined && spirv_read(module, inlined, count) && spirv_reach(module);
}

static struct spirv_block parameters(const struct child *child, uint32_t pass)
{
    const struct dt_pipeline *info = child->pipeline->info;
    const struct dt_program *program = &child->pipeline->vk->panel->programs[pass];
    struct spirv_block block = {UINT32_MAX, info->live_defaults, info->block_size};
    for (uint32_t i = 0; i < program->binding_count; i++)
        if (program->bindings[i].resource == DT_LIVE)
            block.binding = program->bindings[i].binding;
    return block;
}

/* Whether the loop or one around it has known turns: then it counts for more, or less, than the compiler says. */
static bool counts(const struct spirv_loop *loops, uint32_t loop)
{
    while (!loops[loop].turns && loops[loop].around != loop)
        loop = loops[loop].around;
    return loops[loop].turns;
}

static bool is_kept(const cJSON *item, const cJSON *told)
{
    const cJSON *kept = cJSON_GetObjectItem(told, "kept");
    return !kept ||
           cJSON_Compare(cJSON_GetObjectItem(kept, "Instructions"),
                         cJSON_GetObjectItem(cJSON_GetObjectItem(item, "inlined"), "Instructions"),
                         true);
}

static bool add_loops(const struct child *child, cJSON *item, const struct vk_executable *plain)
{
    const struct spirv_block block = parameters(child, plain->pass);
    cJSON *list = cJSON_AddArrayToObject(item, "loops");
    struct spirv_loop loops[MOST_LOOPS];
    struct spirv module = {0};
    bool good = take_stage(child, plain, &module);
    if (!good)
        report_error(child->log, "pass %s: not enough memory to read its loops",
                     child->pipeline->info->passes[plain->pass].name);
    uint32_t count = good ? spirv_find_loops(&module, &block, loops, MOST_LOOPS) : 0, known = 0;
    for (uint32_t i = 0; i < count; i++)
        known += loops[i].turns > 0;
    good = good && (!known || add_compiled(child, item, "inlined", plain, &module));
    for (uint32_t i = 0; good && i < count; i++) {
        cJSON *told = cJSON_CreateObject();
        cJSON_AddNumberToObject(told, "turns", loops[i].turns);
        cJSON_AddNumberToObject(told, "around", loops[i].around);
        if (loops[i].turns)
            good = add_changed(child, told, false, plain, &module, loops[i].merge);
        if (good && counts(loops, i) && is_kept(item, told))
            good = add_changed(child, told, true, plain, &module, loops[i].merge);
        cJSON_AddItemToArray(list, told);
    }
    spirv_free(&module);
    return good;
}

/* Whether the compiler weighs loops, as RADV's does for this figure. */
static bool weighs_loops(const struct vk_executable *executable)
{
    bool found = false;
    for (uint32_t i = 0; i < executable->count; i++)
        found |= !strcmp(executable->list[i].name, "Inverse Throughput");
    return found;
}

/* ---- The child's answer ------------------------------------------------------------------------ */

static bool add_stage(const struct child *child, cJSON *stages,
                      const struct vk_executable *executable)
{
    const char *stage = executable->stages & VK_SHADER_STAGE_COMPUTE_BIT    ? "compute"
                        : executable->stages & VK_SHADER_STAGE_FRAGMENT_BIT ? "fragment"
                                                                            : "vertex";
    cJSON *item = cJSON_CreateObject();
    cJSON_AddItemToArray(stages, item);
    cJSON_AddNumberToObject(item, "pass", executable->pass);
    cJSON_AddStringToObject(item, "stage", stage);
    cJSON_AddNumberToObject(item, "subgroup", executable->subgroup ? executable->subgroup : 1);
    add_figures(item, "figures", executable);
    return !weighs_loops(executable) || add_loops(child, item, executable);
}

static bool add_stages(const struct child *child, cJSON *stages)
{
    const struct pipeline *pipeline = child->pipeline;
    bool good = true;
    for (uint32_t pass = 0; good && pass < pipeline->info->pass_count; pass++) {
        struct vk_executables found;
        good = vk_statistics_ask(child->asking, pass, &pipeline->vk->stages[pass], &found);
        for (uint32_t i = 0; good && i < found.count; i++)
            good = add_stage(child, stages, &found.list[i]);
    }
    return good;
}

/* A family has other names in other versions of RADV, which refuses unknown ones. */
static _Noreturn void answer(FILE *out, const struct pipeline *pipeline, const char *family,
                             size_t length, const char *device)
{
    cJSON *root = cJSON_CreateObject(), *stages = cJSON_CreateArray();
    const struct dt_runtime_options options = {
        .log = {keep_error, root}, .device = device, .panel = pipeline->vk->panel};
    if (family && !freopen("/dev/null", "w", stderr)) /* of an unknown family */
        _exit(EXIT_FAILED);
    struct child child = {.pipeline = pipeline, .log = &options.log};
    if (!family || choose_radv(family, length))
        child.asking = vk_statistics_open(&options, pipeline->vk);
    if (child.asking && add_stages(&child, stages)) {
        const char *driver, *name = vk_statistics_device(child.asking, &driver);
        cJSON_AddStringToObject(root, "device", name);
        cJSON_AddStringToObject(root, "driver", driver);
        cJSON_AddItemToObject(root, "stages", stages);
    }
    vk_statistics_close(child.asking);
    char *text = cJSON_PrintUnformatted(root);
    _exit(text && fputs(text, out) >= 0 && fflush(out) == 0 ? EXIT_FINE : EXIT_FAILED);
}

/* ---- The parent ------------------------------------------------------------------------------ */

/* What one child answers; NULL: with *error, its message. */
static cJSON *ask(const char *family, size_t length, const char *device,
                  const struct pipeline *pipeline, struct console *console, char **error)
{
    int ends[2] = {-1, -1};
    char *text = NULL;
    size_t size = 0;
    fflush(stdout);
    pid_t child = pipe(ends) == 0 ? console_fork(console) : -1;
    if (child == 0)
        answer(fdopen(ends[1], "w"), pipeline, family, length, device);
    close(ends[1]);
    FILE *in = fdopen(ends[0], "r");
    cJSON *got = child > 0 && in && getdelim(&text, &size, '\0', in) > 0 ? cJSON_Parse(text) : NULL;
    if (in)
        fclose(in);
    free(text);
    int status = child > 0 ? console_wait(console, child) : -1;
    if (cJSON_HasObjectItem(got, "stages"))
        return got;
    const char *told = cJSON_GetStringValue(cJSON_GetObjectItem(got, "error"));
    free(*error);
    *error = status > 0 && WIFSIGNALED(status)
                 ? format_string("the driver has crashed (signal %d)", WTERMSIG(status))
                 : strdup(told        ? told
                          : child > 0 ? "the driver has ended"
                                      : strerror(errno));
    cJSON_Delete(got);
    return NULL;
}

cJSON *cost_ask(const struct cost_chip *chip, const char *device, const struct pipeline *pipeline,
                struct console *console)
{
    const char *name = chip ? chip->name : device, *family = chip ? chip->family : NULL;
    char *error = NULL;
    cJSON *gpu = NULL;
    console_status(console, "compiling for %s", name);
    if (!chip)
        gpu = ask(NULL, 0, device, pipeline, console, &error);
    for (size_t length; family && *family && !gpu; family += length + (family[length] == '|')) {
        length = strcspn(family, "|");
        gpu = ask(family, length, NULL, pipeline, console, &error);
    }
    if (!gpu)
        report_error(&console->log, "%s: %s", name, error ? error : "out of memory");
    else
        cJSON_AddItemToObject(gpu, "chip", chip ? cJSON_CreateString(name) : cJSON_CreateNull());
    free(error);
    return gpu;
}
