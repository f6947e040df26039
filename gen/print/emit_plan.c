/* The plan as JSON, and the drawings that templates/drawings.py makes of it for Graphviz. Sizes are those of
 * the reference frame. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/installed.h"
#include "emit_c.h"

extern char **environ;

/* ---- The plan -------------------------------------------------------------------------------- */

static void add_string(struct text *out, const char *key, const char *value)
{
    text_add(out, "\"%s\": ", key);
    if (value)
        text_add_json(out, value);
    else
        text_add(out, "null");
    text_add(out, ", ");
}

static void add_numbers(struct text *out, const char *key, const uint32_t *numbers, uint32_t count)
{
    text_add(out, "\"%s\": [", key);
    for (uint32_t i = 0; i < count; i++)
        text_add(out, i ? ", %" PRIu32 : "%" PRIu32, numbers[i]);
    text_add(out, "], ");
}

static const char *truth(bool value)
{
    return value ? "true" : "false";
}

static void add_resource(struct text *out, const struct resource *resource)
{
    static const uint32_t frame[3] = {REFERENCE_WIDTH, REFERENCE_HEIGHT, 1};
    bool image = resource->kind == DT_IMAGE;
    uint32_t size[3], axes = !image ? 1 : resource->layers ? 3 : 2;
    for (uint32_t i = 0; i < axes; i++)
        size[i] = expr_at_reference(resource_size(resource, (int)i), image ? frame[i] : 1);
    add_string(out, "name", resource->name);
    add_string(out, "type",
               image                 ? format_info(resource->format)->name
               : resource->structure ? resource->structure->name
                                     : type_info(resource->type)->name);
    add_numbers(out, "size", size, axes);
    text_add(out,
             "\"image\": %s, \"history\": %s, \"input\": %s, \"mips\": %" PRIu32
             ", \"bytes\": %" PRIu64 ", \"first\": %d, \"last\": %d, \"slot\": %" PRIu32
             ", \"share\": %d",
             truth(image), truth(resource->history), truth(resource->input), mips_of(resource),
             resource->bytes, resource->first_pass, resource->last_pass, resource->slot,
             resource->share);
}

/* Resources that the pass reads, or those that it writes. */
static void add_uses(struct text *out, const char *key, const struct pipeline *pipeline,
                     const struct pass *pass, bool writes)
{
    const char *before = "";
    text_add(out, "\"%s\": [", key);
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        struct pass_use use = pass_use_of(pass, &pipeline->resources[i]);
        if (!use.updates && !(writes ? use.writes : use.reads))
            continue;
        text_add(out, "%s%" PRIu32, before, i);
        before = ", ";
    }
    text_add(out, "], ");
}

static void add_work(struct text *out, const struct pass *pass, struct arena *arena)
{
    static const char *const kinds[] = {[DT_PASS_DRAW_SCENE] = "scene",
                                        [DT_PASS_DRAW_FULLSCREEN] = "fullscreen",
                                        [DT_PASS_DRAW_VERTICES] = "vertices",
                                        [DT_PASS_DISPATCH] = "dispatch"};
    static const char *const topologies[] = {"triangles", "lines", "points"};
    const struct steps steps = pass_steps(pass, arena);
    const struct step *work = steps.list ? steps_work(&steps) : NULL;
    uint32_t groups[3] = {0};
    for (int axis = 0; axis < 3 && work && work->verb == DT_VERB_DISPATCH; axis++)
        groups[axis] =
            (uint32_t)amount_value(&work->arguments[axis], REFERENCE_WIDTH, REFERENCE_HEIGHT, NULL);
    out->failed |= !work;
    add_string(out, "kind", kinds[pass->kind]);
    add_string(out, "topology", topologies[pass->topology]);
    add_string(out, "view", pass->view);
    add_numbers(out, "groups", groups, 3);
    add_numbers(out, "local", pass->local, 3);
    text_add(out, "\"layers\": %" PRIu32 ", \"indirect\": %s, ",
             pass->layers ? expr_at_reference(pass->layers, 1) : 0, truth(pass->indirect_resource));
}

static void add_barriers(struct text *out, const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->barrier_count; i++) {
        const struct barrier *barrier = &pass->barriers[i];
        text_add(out,
                 "%s{\"resource\": %" PRIu32 ", \"alias\": %d, \"from\": [%u, %u], "
                 "\"to\": [%u, %u], \"writes\": %s}",
                 i ? ", " : "", barrier->resource->index,
                 barrier->alias ? (int)barrier->alias->index : -1, barrier->from,
                 barrier->from_stages, barrier->to, barrier->to_stages,
                 truth(barrier->from_writes));
    }
}

static void add_planned_pass(struct text *out, const struct model *model, const struct pass *pass)
{
    add_string(out, "name", pass->name);
    add_string(out, "when", pass->conditional ? pass->when_text : NULL);
    add_work(out, pass, model->arena);
    add_uses(out, "reads", &model->pipeline, pass, false);
    add_uses(out, "writes", &model->pipeline, pass, true);
    text_add(out, "\"line\": %d, \"runs\": %s, \"scene\": [", pass->loc.line,
             truth(expr_at_reference(pass->when, 1)));
    const char *before = "";
    EACH(access, pass->accesses, pass->access_count)
        if (!access->resource) {
            text_add(out, "%s\"%s\"", before, access->name);
            before = ", ";
        }
    text_add(out, "], \"barriers\": [");
    add_barriers(out, pass);
    text_add(out, "]");
}

static void emit_plan(const struct model *model, struct text *out)
{
    const struct pipeline *pipeline = &model->pipeline;
    text_add(out, "{");
    add_string(out, "name", pipeline->name);
    add_string(out, "linear", pipeline->linear_output);
    add_string(out, "display", pipeline->display_output);
    text_add(out,
             "\"frame\": [%d, %d], \"transients\": %" PRIu64 ", \"aliased\": %" PRIu64
             ", \"resources\": [",
             REFERENCE_WIDTH, REFERENCE_HEIGHT, pipeline->transient_bytes, pipeline->aliased_bytes);
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        text_add(out, i ? "}, {" : "{");
        add_resource(out, &pipeline->resources[i]);
    }
    text_add(out, pipeline->resource_count ? "}], \"passes\": [" : "], \"passes\": [");
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        text_add(out, i ? "}, {" : "{");
        add_planned_pass(out, model, pipeline->order[i]);
    }
    text_add(out, pipeline->pass_count ? "}], \"dropped\": [" : "], \"dropped\": [");
    for (uint32_t i = 0; i < pipeline->dropped_count; i++) {
        text_add(out, i ? ", {" : "{");
        add_string(out, "name", pipeline->dropped[i]->name);
        add_string(out, "when", pipeline->dropped[i]->when_text);
        text_add(out, "\"line\": %d}", pipeline->dropped[i]->loc.line);
    }
    text_add(out, "]}\n");
}

/* ---- Drawings -------------------------------------------------------------------------------- */

/* What the script prints. Returns 0 or an errno; -1: the script has failed, and told why. */
static int run_script(const char *script, const char *drawing, FILE *plan, struct text *out)
{
    const char *const argv[] = {"/usr/bin/python3", script, drawing, NULL};
    posix_spawn_file_actions_t actions;
    char buffer[4096];
    int ends[2], status = 0;
    pid_t child;
    if (pipe2(ends, O_CLOEXEC))
        return errno;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(plan), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    int error = posix_spawn(&child, argv[0], &actions, NULL, (char *const *)argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    for (ssize_t got; !error && (got = read(ends[0], buffer, sizeof buffer)) > 0;)
        text_add_bytes(out, buffer, (size_t)got);
    close(ends[0]);
    if (!error && (waitpid(child, &status, 0) < 0 || status))
        error = -1;
    return error;
}

bool emit_drawing(const struct model *model, const char *drawing, struct text *out)
{
    const struct dt_log log = {0};
    struct text plan = {0};
    char *templates = templates_folder(&log);
    char *script = templates ? format_string("%s/drawings.py", templates) : NULL;
    FILE *file = script ? tmpfile() : NULL;
    emit_plan(model, &plan);
    out->failed |= plan.failed || !file;
    int error = out->failed || fwrite(plan.data, 1, plan.length, file) < plan.length ||
                        fflush(file) || fseek(file, 0, SEEK_SET)
                    ? errno
                    : run_script(script, drawing, file, out);
    if (error)
        fprintf(stderr, "diptych-gen: error: --%s: /usr/bin/python3 %s: %s\n", drawing,
                script ? script : "", error > 0 ? strerror(error) : "it failed");
    if (file)
        fclose(file);
    free(script);
    free(templates);
    text_free(&plan);
    return !error;
}
