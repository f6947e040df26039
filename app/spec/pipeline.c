/* Loads pipelines; see pipeline.h. */
#include "spec/pipeline.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "result/live.h"
#include "console/tool.h"
#include "gen/plan/sanitize.h"
#include "result/contracts.h"
#include "spec/inputs.h"
#include "base/nearest.h"

/* Processor time after which a spec hangs. */
#define TRY_SECONDS "30"

/* The folders and the spec of a load, as real paths; owned. */
struct load {
    char *tools, *spec, *templates;
    char *cache; /* NULL: none */
};

/* Of NULL: of the project's own; logged; free(). */
static char *find_spec_path(const char *spec, const struct dt_log *log)
{
    char *templates = spec ? NULL : templates_folder(log);
    char *wanted = spec        ? find_spec(spec, log)
                   : templates ? format_string("%s/ssvp.yaml", templates)
                               : NULL;
    char *path = wanted ? realpath(wanted, NULL) : NULL;
    if (!path)
        report_error(log, "%s: the spec cannot be read: %s", wanted ? wanted : "spec",
                     strerror(errno));
    free(wanted);
    free(templates);
    return path;
}

/* ---- Cache ----------------------------------------------------------------------------------- */

static bool is_writable(const char *folder)
{
    struct stat info;
    return access(folder, W_OK) == 0 && stat(folder, &info) == 0 && S_ISDIR(info.st_mode);
}

/* BASE/NAME where BASE is there, or can be made, and written; else NULL. */
static char *folder_in(const char *base, const char *name)
{
    char *folder = base && *base == '/' ? format_string("%s%s", base, name) : NULL;
    if (base && *base == '/' && mkdir(base, 0700) == 0)
        return folder;
    if (folder && (is_writable(folder) || (access(folder, F_OK) != 0 && is_writable(base))))
        return folder;
    free(folder);
    return NULL;
}

/* Folder of compiled shaders: build/cache where that can be written, else the user's own cache folder, as for
 * what is installed; free(). NULL: neither can be written, and there is no cache. */
static char *cache_folder(const char *tools)
{
    const char *home = getenv("HOME");
    char *own = home ? format_string("%s/.cache", home) : NULL;
    char *folder = tools_installed(tools) ? NULL : folder_in(tools, "/cache");
    folder = folder ? folder : folder_in(getenv("XDG_CACHE_HOME"), "/diptych");
    folder = folder ? folder : folder_in(own, "/diptych");
    free(own);
    return folder;
}

/* ---- Load ------------------------------------------------------------------------------------ */

static bool find_files(struct load *load, const struct setup *setup, const struct dt_log *log)
{
    *load = (struct load){.tools = tools_folder(log)};
    load->spec = load->tools ? find_spec_path(setup->spec, log) : NULL;
    load->templates = !load->spec        ? NULL
                      : setup->templates ? realpath(setup->templates, NULL)
                                         : templates_folder(log);
    if (load->spec && !load->templates)
        report_error(log, "%s: cannot be read: %s",
                     setup->templates ? setup->templates : "templates", strerror(errno));
    load->cache = load->templates ? cache_folder(load->tools) : NULL;
    return load->templates;
}

static void load_forget(struct load *load)
{
    free(load->cache);
    free(load->templates);
    free(load->spec);
    free(load->tools);
}

static bool take_plan(struct pipeline *pipeline, struct load *load, const struct dt_log *log)
{
    pipeline->info = plan_pipeline(pipeline->plan);
    pipeline->gl = plan_shaders(pipeline->plan, "gl");
    pipeline->vk = plan_shaders(pipeline->plan, "vk");
    pipeline->live = malloc(pipeline->info->live_size);
    if (!pipeline->live)
        return report_error(log, "out of memory");
    memcpy(pipeline->live, pipeline->info->live_defaults, pipeline->info->live_size);
    pipeline->spec = load->spec;
    pipeline->templates = load->templates;
    load->spec = load->templates = NULL;
    return true;
}

/* Whether a driver for OpenGL is to compile GLSL. */
static bool takes_text(const struct setup *setup)
{
    return setup->glsl || (setup->backend && strstr(setup->backend, "+glsl"));
}

/* The mask of --sanitize; 0 without it. */
static bool read_kinds(const struct setup *setup, unsigned *kinds, const struct dt_log *log)
{
    const char *end;
    *kinds = setup->sanitize ? sanitize_kinds(setup->sanitize, &end) : 0;
    if (setup->sanitize && !*kinds)
        report_error(log, "--sanitize=%s: unknown kind \"%.*s\"; there are %s", setup->sanitize,
                     (int)strcspn(end, ","), end, SANITIZE_WORDS);
    return *kinds || !setup->sanitize;
}

bool pipeline_load(struct pipeline *pipeline, struct console *console, const struct setup *setup)
{
    struct load load;
    *pipeline = (struct pipeline){0};
    unsigned sanitize;
    bool good =
        find_files(&load, setup, &console->log) && read_kinds(setup, &sanitize, &console->log);
    if (good) {
        const struct spec_request request = {.path = load.spec,
                                             .templates = load.templates,
                                             .sets = setup->sets,
                                             .set_count = setup->set_count,
                                             .cache = load.cache,
                                             .root = setup->root,
                                             .exact_twin = setup->exact_twin,
                                             .gpu = setup->for_gpu,
                                             .text = takes_text(setup),
                                             .sanitize = sanitize};
        console_status(console, "planning %s", load.spec);
        pipeline->plan = plan_load(request, console);
        good = pipeline->plan && take_plan(pipeline, &load, &console->log);
    }
    load_forget(&load);
    if (!good)
        pipeline_unload(pipeline);
    return good;
}

static bool run_generator(const struct load *load, const struct setup *setup, const char *target,
                          struct console *console)
{
    static const struct tool generator = {
        .what = "reading the spec", .hint = "build the project with ninja", .explains = true};
    char *tool = format_string("%s/diptych-gen", load->tools);
    char **argv = calloc(setup->set_count * 2 + 14, sizeof *argv);
    bool good = false;
    if (tool && argv) {
        const char *const words[] = {tool,
                                     load->spec,
                                     "--check",
                                     "--limit",
                                     TRY_SECONDS,
                                     "--templates",
                                     load->templates,
                                     load->cache ? "--cache" : NULL,
                                     load->cache,
                                     target ? "--set" : NULL,
                                     target};
        size_t n = 0;
        for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
            if (words[i])
                argv[n++] = (char *)words[i];
        for (uint32_t i = 0; i < setup->set_count; i++) {
            argv[n++] = (char *)"--set";
            argv[n++] = (char *)setup->sets[i];
        }
        good = tool_run(&generator, argv, -1, console);
    } else {
        report_error(&console->log, "out of memory");
    }
    free(argv);
    free(tool);
    return good;
}

bool pipeline_try(struct console *console, const struct setup *setup, const char *target)
{
    struct load load;
    bool good =
        find_files(&load, setup, &console->log) && run_generator(&load, setup, target, console);
    load_forget(&load);
    return good;
}

void pipeline_unload(struct pipeline *pipeline)
{
    for (uint32_t i = 0; i < pipeline->input_count; i++)
        for (uint32_t mip = 0; mip < pipeline->inputs[i].mips; mip++)
            free(pipeline->inputs[i].mip[mip].data);
    free(pipeline->input_hashes);
    free(pipeline->inputs);
    free(pipeline->live);
    free(pipeline->templates);
    free(pipeline->spec);
    plan_free(pipeline->plan);
    *pipeline = (struct pipeline){0};
}

struct identity pipeline_identity(const struct pipeline *pipeline, const struct scene *scene,
                                  const struct setup *setup)
{
    struct identity identity = {.pipeline = pipeline->info,
                                .live = pipeline->live,
                                .spec = pipeline->spec,
                                .templates = pipeline->templates,
                                .inputs = pipeline->input_hashes,
                                .input_count = pipeline->input_hash_count,
                                .scene = scene,
                                .setup = setup,
                                .size = {setup->size[0], setup->size[1]},
                                .frame = setup->frames - 1};
    identity.sources = plan_sources(pipeline->plan, &identity.source_count);
    return identity;
}

/* ---- By name --------------------------------------------------------------------------------- */

/* Every `stride` bytes from `first` on stands a struct that begins with a name. */
static void refuse_name(const struct dt_pipeline *info, const char *what, const char *name,
                        const char *kind, const void *first, size_t stride, uint32_t count,
                        const struct dt_log *log)
{
    const char **names = calloc(count + 1, sizeof *names);
    for (uint32_t i = 0; names && i < count; i++)
        memcpy(&names[i], (const char *)first + i * stride, sizeof *names);
    report_error(log, "%s %s: %s has no such %s%s", what, name, info->name, kind,
                 name_hint('"', name, names, count, "").text);
    free(names);
}

bool pipeline_find(const struct dt_pipeline *info, const char *what, const char *name,
                   uint32_t *resource, const struct dt_log *log)
{
    for (uint32_t i = 0; i < info->resource_count; i++)
        if (strcmp(info->resources[i].name, name) == 0) {
            *resource = i;
            return true;
        }
    refuse_name(info, what, name, "resource", info->resources, sizeof *info->resources,
                info->resource_count, log);
    return false;
}

const struct dt_param *pipeline_find_live(const struct dt_pipeline *info, const char *what,
                                          const char *name, const struct dt_log *log)
{
    const struct dt_param *param = live_param(info, name);
    if (!param)
        refuse_name(info, what, name, "parameter", info->params, sizeof *info->params,
                    info->param_count, log);
    else if (!param->live)
        report_error(log, "%s %s: it is not live: give its value when the spec is read", what,
                     name);
    return param && param->live ? param : NULL;
}

/* ---- Contracts --------------------------------------------------------------------------------- */

static bool is_drawn(const struct dt_pipeline *info, uint32_t resource)
{
    for (uint32_t i = 0; i < info->pass_count; i++)
        for (uint32_t k = 0; k < info->passes[i].write_count; k++)
            if (info->passes[i].kind == DT_PASS_DRAW_SCENE && info->passes[i].writes[k] == resource)
                return true;
    return false;
}

static bool find_margin(const struct dt_pipeline *info, const struct kept_contract *kept,
                        struct dt_contract *contract)
{
    for (uint32_t i = 0; i < info->resource_count && kept->margin; i++) {
        int16_t field = contracts_margin(kept, &info->resources[i]);
        if (field >= 0) {
            contract->margin_resource = (uint16_t)i;
            contract->margin_field = field;
            return true;
        }
    }
    return !kept->margin;
}

/* Whether a pass writes the resource that its `exactness` leaves free. */
static bool is_free(const struct pipeline *pipeline, uint32_t resource)
{
    const struct dt_pipeline *info = pipeline->info;
    for (uint32_t i = 0; i < info->pass_count; i++)
        for (uint32_t k = 0; k < info->passes[i].write_count && plan_is_bounded(pipeline->plan, i);
             k++)
            if (info->passes[i].writes[k] == resource)
                return true;
    return false;
}

static bool set_contract(const struct pipeline *pipeline, uint32_t index,
                         const struct kept_contract *kept, const char *path,
                         const struct dt_log *log)
{
    /* the plan, which the pipeline owns, has made them */
    const struct dt_pipeline *info = pipeline->info;
    struct dt_resource *resource = (struct dt_resource *)&info->resources[index];
    resource->contract = kept->contract;
    const char *wrong = NULL;
    if (kept->contract.kind == DT_CONTRACT_RASTER && !is_drawn(info, index))
        wrong = "`raster` is for images that a draw of the scene writes";
    else if (kept->contract.kind == DT_CONTRACT_OF_EXACT && !is_free(pipeline, index))
        wrong = "`of_exact` is for what passes write that their `exactness` leaves free";
    else if (kept->contract.kind == DT_CONTRACT_IMAGE && resource->kind == DT_BUFFER)
        wrong = "`image` is for images";
    else if (!find_margin(info, kept, &resource->contract))
        wrong = "`margin` names no buffer of floats, and no float of a buffer";
    if (wrong)
        report_error(log, "%s: %s: %s", path, resource->name, wrong);
    return !wrong;
}

bool pipeline_contracts(struct pipeline *pipeline, const char *path, struct contracts *contracts,
                        const struct dt_log *log)
{
    const struct dt_pipeline *info = pipeline->info;
    const char **names = calloc(info->resource_count + 1, sizeof *names);
    for (uint32_t i = 0; names && i < info->resource_count; i++)
        names[i] = info->resources[i].name;
    bool good = names && contracts_read(contracts, path, names, info->resource_count, log);
    if (!names)
        report_error(log, "out of memory");
    for (uint32_t i = 0; i < info->resource_count && good; i++) {
        const struct kept_contract *kept = contracts_find(contracts, "", info->resources[i].name);
        good = !kept || set_contract(pipeline, i, kept, path, log);
    }
    free(names);
    return good;
}
