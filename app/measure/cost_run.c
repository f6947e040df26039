/* Asks a driver's compiler about a pipeline, in a child process: the environment that chooses RADV and its
 * chip must not reach our own drivers, and a compiler may crash. */
#include <errno.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

#include "base/files.h"
#include "measure/cost.h"
#include "runtime_vk/statistics.h"

const char *const cost_names[COST_NUMBERS] = {
    [COST_VGPRS] = "vgprs",
    [COST_WAVES] = "waves",
    [COST_SPILLS] = "spills",
    [COST_SCRATCH] = "scratch",
    [COST_CODE] = "code",
    [COST_LDS] = "lds",
    [COST_INSTRUCTIONS] = "instructions",
    [COST_CYCLES] = "cycles",
    [COST_LATENCY] = "latency",
};

/* Names that drivers give: RADV's first, then those of other drivers. Numbers of one kind are added. */
static const struct {
    enum cost_number number;
    const char *name;
} known[] = {
    {COST_VGPRS, "VGPRs"},
    {COST_WAVES, "Subgroups per SIMD"},
    {COST_SPILLS, "Spilled VGPRs"},
    {COST_SPILLS, "Spilled SGPRs"},
    {COST_SCRATCH, "Scratch size"},
    {COST_CODE, "Code size"},
    {COST_LDS, "LDS size"},
    {COST_INSTRUCTIONS, "Instructions"},
    {COST_CYCLES, "Inverse Throughput"},
    {COST_LATENCY, "Latency"},
    {COST_INSTRUCTIONS, "Instruction Count"}, /* Intel, Turnip */
    {COST_SPILLS, "Spill Count"},
    {COST_CODE, "Code Size"}, /* NVK */
    {COST_INSTRUCTIONS, "Instruction count"},
    {COST_VGPRS, "Register Count"}, /* NVIDIA */
};

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

/* What goes through the pipe, followed by `count` executables. */
struct answer {
    bool good;
    uint32_t count;
    char device[256], driver[520];
    char error[512];
};

static void keep_error(void *user, enum dt_level level, const char *message)
{
    struct answer *answer = user;
    if (level == DT_ERROR)
        snprintf(answer->error, sizeof answer->error, "%s", message);
}

static bool write_whole(int file, const void *data, size_t size)
{
    for (const char *at = data; size;) {
        ssize_t done = write(file, at, size);
        if (done < 0 && errno != EINTR)
            return false;
        at += done > 0 ? done : 0;
        size -= done > 0 ? (size_t)done : 0;
    }
    return true;
}

/* A family has other names in other versions of RADV, which refuses unknown ones. */
static void answer(int file, const struct pipeline *pipeline, const char *family, size_t length,
                   const char *device)
{
    struct answer answer = {0};
    struct vk_statistics found = {0};
    const struct dt_runtime_options options = {
        .log = {keep_error, &answer}, .device = device, .panel = pipeline->vk->panel};
    if (family && !freopen("/dev/null", "w", stderr)) /* of an unknown family */
        _exit(EXIT_FAILED);
    answer.good = (!family || choose_radv(family, length)) &&
                  vk_statistics_find(&options, pipeline->vk, &found);
    answer.count = found.count;
    memcpy(answer.device, found.device, sizeof answer.device);
    memcpy(answer.driver, found.driver, sizeof answer.driver);
    bool sent = write_whole(file, &answer, sizeof answer) &&
                write_whole(file, found.list, found.count * sizeof *found.list);
    _exit(sent ? EXIT_FINE : EXIT_FAILED);
}

/* ---- The parent ------------------------------------------------------------------------------ */

static bool read_whole(int file, void *data, size_t size)
{
    for (char *at = data; size;) {
        ssize_t done = read(file, at, size);
        if (done == 0 || (done < 0 && errno != EINTR))
            return false;
        at += done > 0 ? done : 0;
        size -= done > 0 ? (size_t)done : 0;
    }
    return true;
}

static const char *stage_name(uint32_t stages)
{
    return stages & VK_SHADER_STAGE_COMPUTE_BIT    ? "compute"
           : stages & VK_SHADER_STAGE_FRAGMENT_BIT ? "fragment"
                                                   : "vertex";
}

static struct cost_stage stage_of(const struct vk_executable *executable)
{
    struct cost_stage stage = {.pass = executable->pass,
                               .stage = stage_name(executable->stages),
                               .subgroup = executable->subgroup ? executable->subgroup : 1};
    for (int i = 0; i < COST_NUMBERS; i++)
        stage.numbers[i] = NAN;
    for (size_t i = 0; i < DT_ARRAY_COUNT(known); i++)
        for (uint32_t k = 0; k < executable->count; k++) {
            double *number = &stage.numbers[known[i].number];
            if (strcmp(executable->list[k].name, known[i].name) == 0)
                *number = (isnan(*number) ? 0 : *number) + executable->list[k].value;
        }
    return stage;
}

static bool take_answer(int file, struct cost_gpu *gpu, struct answer *answer)
{
    struct vk_executable executable;
    if (!read_whole(file, answer, sizeof *answer))
        return false;
    memcpy(gpu->device, answer->device, sizeof gpu->device);
    memcpy(gpu->driver, answer->driver, sizeof gpu->driver);
    gpu->stages = calloc(answer->count + 1, sizeof *gpu->stages);
    for (gpu->count = 0; gpu->stages && gpu->count < answer->count; gpu->count++) {
        if (!read_whole(file, &executable, sizeof executable))
            return false;
        gpu->stages[gpu->count] = stage_of(&executable);
    }
    return gpu->stages;
}

/* Asks one child. *error is its message, or "" where it ended without one. */
static bool ask(struct cost_gpu *gpu, const char *family, size_t length, const char *device,
                const struct pipeline *pipeline, struct console *console, char **error)
{
    int ends[2] = {-1, -1};
    struct answer got = {0};
    fflush(stdout);
    pid_t child = pipe(ends) == 0 ? console_fork(console) : -1;
    if (child == 0)
        answer(ends[1], pipeline, family, length, device);
    close(ends[1]);
    bool good = child > 0 && take_answer(ends[0], gpu, &got);
    close(ends[0]);
    int status = child > 0 ? console_wait(console, child) : -1;
    if (!good && status > 0 && WIFSIGNALED(status))
        *error = format_string("the driver has crashed (signal %d)", WTERMSIG(status));
    else
        *error = strdup(good || child > 0 ? got.error : strerror(errno));
    return good && got.good;
}

void cost_gpu_free(struct cost_gpu *gpu)
{
    free(gpu->stages);
    free(gpu->measured);
    gpu->stages = NULL;
    gpu->measured = NULL;
    gpu->count = 0;
}

bool cost_ask(struct cost_gpu *gpu, const struct cost_chip *chip, const char *device,
              const struct pipeline *pipeline, struct console *console)
{
    const char *name = chip ? chip->name : device ? device : "the first device";
    char *error = NULL;
    bool good = false;
    *gpu = (struct cost_gpu){0};
    console_status(console, "compiling for %s", name);
    if (!chip) {
        good = ask(gpu, NULL, 0, device, pipeline, console, &error);
    } else {
        const char *family = chip->family;
        for (size_t length; *family && !good; family += length + (family[length] == '|')) {
            length = strcspn(family, "|");
            cost_gpu_free(gpu);
            free(error);
            good = ask(gpu, family, length, NULL, pipeline, console, &error);
        }
    }
    if (!good)
        report_error(&console->log, "%s: %s", name,
                     error && *error ? error : "the driver has ended");
    free(error);
    gpu->chip = chip ? chip : cost_chip_of(gpu->device);
    return good;
}
