/* From a spec to tables; see load.h. */
#include "load.h"

#include <string.h>

#include "check/check.h"
#include "plan/plan.h"
#include "plan/sanitize.h"
#include "read/read.h"
#include "spirv/shader_cache.h"

static bool read(struct spec *spec, const struct spec_request *request, struct diag *diag)
{
    spec->model.arena = spec->model.arena ? spec->model.arena : arena_create();
    if (!spec->model.arena) {
        diag_error(diag, (struct loc){0}, "out of memory");
        return false;
    }
    spec->model.templates_dir = request->templates;
    spec->model.root = request->root;
    spec->model.prove = request->prove;
    spec->model.exact_twin = request->exact_twin;
    spec->model.gpu = request->gpu;
    spec->model.text = request->text;
    spec->model.sanitize = request->sanitize;
    return read_spec(&spec->model, request->path, request->sets, request->set_count, diag);
}

static bool run_stages(struct spec *spec, const struct spec_request *request, bool tables,
                       struct diag *diag)
{
    struct model *model = &spec->model;
    if (!read(spec, request, diag) || !check_model(model, model->templates_dir, diag) ||
        diag_error_count(diag))
        return false;
    layout_model(model);
    if (!plan_model(model, diag) || diag_error_count(diag))
        return false;
    struct shader_cache *cache =
        model->sanitize ? NULL : shader_cache_open(request->cache, diag); /* it knows no sites */
    bool good = sanitize_begin(model) && shaders_compile(model, spec->shaders, cache, diag) &&
                sanitize_count(model, diag);
    shader_cache_close(cache);
    if (!good)
        return false;
    spec->tables = tables ? lower(model, spec->shaders) : NULL;
    if (tables && !spec->tables)
        diag_error(diag, (struct loc){0}, "out of memory");
    return !tables || spec->tables;
}

bool spec_load(struct spec *spec, const struct spec_request *request, bool tables,
               struct diag *diag)
{
    memory_forget();
    bool good = run_stages(spec, request, tables, diag);
    if (memory_was_lost() || (!good && !diag_error_count(diag))) { /* all else is reported */
        diag_error(diag, (struct loc){0}, "out of memory");
        return false;
    }
    return good;
}

void spec_free(struct spec *spec)
{
    shaders_free(&spec->model, spec->shaders);
    sanitize_end(&spec->model);
    arena_free(spec->model.arena);
    *spec = (struct spec){0};
}
