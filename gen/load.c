/* From a spec to tables; see load.h. */
#include "load.h"

#include "check/check.h"
#include "plan/plan.h"
#include "plan/sanitize.h"
#include "read/read.h"
#include "spirv/shader_cache.h"

static bool read(struct spec *spec, const struct spec_request *request, struct diag *diag)
{
    spec->model.arena = spec->model.arena ? spec->model.arena : arena_create();
    if (!spec->model.arena)
        return diag_error(diag, (struct loc){0}, "out of memory");
    spec->model.templates_dir = request->templates;
    spec->model.root = request->root;
    spec->model.prove = request->prove;
    spec->model.exact_twin = request->exact_twin;
    spec->model.gpu = request->gpu;
    spec->model.text = request->text;
    spec->model.codes = request->codes;
    spec->model.sanitize = request->sanitize;
    return read_spec(&spec->model, request->path, request->sets, request->set_count, diag);
}

static bool plan(struct spec *spec, const struct spec_request *request, struct diag *diag)
{
    struct model *model = &spec->model;
    if (!read(spec, request, diag) || !check_model(model, model->templates_dir, diag) ||
        diag_error_count(diag))
        return false;
    layout_model(model);
    return plan_model(model, diag) && !diag_error_count(diag) && sanitize_begin(model);
}

static bool make_tables(struct spec *spec, struct diag *diag)
{
    spec->tables = lower(&spec->model, spec->shaders);
    if (!spec->tables)
        diag_error(diag, (struct loc){0}, "out of memory");
    return spec->tables;
}

static bool run_stages(struct spec *specs[2], const struct spec_request *request, bool tables,
                       struct diag *diags[2])
{
    struct shader_plan plans[2];
    struct spec_request own = *request;
    uint32_t count = 0;
    for (; count < 2 && specs[count]; count++) {
        if (count && !specs[0]->model.pipeline.automatic)
            break;
        own.gpu = own.gpu || count;
        if (!plan(specs[count], &own, diags[count]))
            return false;
        plans[count] =
            (struct shader_plan){&specs[count]->model, specs[count]->shaders, diags[count]};
    }
    struct cache *cache =
        request->sanitize ? NULL : cache_open(request->cache, diags[0]); /* it knows no sites */
    for (uint32_t i = 0; i < count; i++)
        specs[i]->model.cache = cache;
    bool good = shaders_compile(plans, count, cache) && sanitize_count(&specs[0]->model, diags[0]);
    for (uint32_t i = 0; i < count; i++)
        specs[i]->model.cache = NULL;
    cache_close(cache);
    for (uint32_t i = 0; good && tables && i < count; i++)
        good = make_tables(specs[i], diags[i]);
    return good;
}

bool spec_load_both(struct spec *specs[2], const struct spec_request *request, bool tables,
                    struct diag *diags[2])
{
    memory_forget();
    bool good = run_stages(specs, request, tables, diags);
    bool told = diag_error_count(diags[0]) || (specs[1] && diag_error_count(diags[1]));
    if (memory_was_lost() || (!good && !told)) { /* all else is reported */
        diag_error(diags[0], (struct loc){0}, "out of memory");
        return false;
    }
    return good;
}

bool spec_load(struct spec *spec, const struct spec_request *request, bool tables,
               struct diag *diag)
{
    return spec_load_both((struct spec *[]){spec, NULL}, request, tables,
                          (struct diag *[]){diag, NULL});
}

void spec_free(struct spec *spec)
{
    shaders_free(&spec->model, spec->shaders);
    sanitize_end(&spec->model);
    arena_free(spec->model.arena);
    *spec = (struct spec){0};
}
