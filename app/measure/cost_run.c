/* Asks a driver's compiler about a pipeline, in a child process: the environment that chooses RADV and its
 * chip must not reach our own drivers, and a compiler may crash. The answer comes as JSON. */
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

#include "base/files.h"
#include "base/nearest.h"
#include "measure/cost.h"
#include "runtime_vk/statistics.h"

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

static void add_stage(cJSON *stages, const struct vk_executable *executable)
{
    const char *stage = executable->stages & VK_SHADER_STAGE_COMPUTE_BIT    ? "compute"
                        : executable->stages & VK_SHADER_STAGE_FRAGMENT_BIT ? "fragment"
                                                                            : "vertex";
    cJSON *item = cJSON_CreateObject();
    cJSON_AddNumberToObject(item, "pass", executable->pass);
    cJSON_AddStringToObject(item, "stage", stage);
    cJSON_AddNumberToObject(item, "subgroup", executable->subgroup ? executable->subgroup : 1);
    cJSON *figures = cJSON_AddObjectToObject(item, "figures");
    for (uint32_t i = 0; i < executable->count; i++)
        cJSON_AddNumberToObject(figures, executable->list[i].name, executable->list[i].value);
    cJSON_AddItemToArray(stages, item);
}

/* A family has other names in other versions of RADV, which refuses unknown ones. */
static _Noreturn void answer(FILE *out, const struct pipeline *pipeline, const char *family,
                             size_t length, const char *device)
{
    cJSON *root = cJSON_CreateObject();
    struct vk_statistics found = {0};
    const struct dt_runtime_options options = {
        .log = {keep_error, root}, .device = device, .panel = pipeline->vk->panel};
    if (family && !freopen("/dev/null", "w", stderr)) /* of an unknown family */
        _exit(EXIT_FAILED);
    if ((!family || choose_radv(family, length)) &&
        vk_statistics_find(&options, pipeline->vk, &found)) {
        cJSON_AddStringToObject(root, "device", found.device);
        cJSON_AddStringToObject(root, "driver", found.driver);
        cJSON *stages = cJSON_AddArrayToObject(root, "stages");
        for (uint32_t i = 0; i < found.count; i++)
            add_stage(stages, &found.list[i]);
    }
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
