/* The parameters, resources and passes of a pipeline as JSON, for `list` and for hosts. Opens no backend. */
#include "spec/list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "result/live.h"
#include "console/options.h"
#include "picture/texels.h"
#include "result/dump.h"

static const char *shape_name(enum dt_shape shape)
{
    static const char *const names[] = {[DT_SHAPE_2D] = "image",
                                        [DT_SHAPE_3D] = "3D",
                                        [DT_SHAPE_CUBE] = "cube",
                                        [DT_SHAPE_CUBE_ARRAY] = "cubes"};
    return names[shape];
}

/* The decimal number with the fewest digits that is the same float: 0.18, not 0.180000007. */
static double shortest(double value)
{
    char text[32];
    double shorter = value;
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        shorter = strtod(text, NULL);
        if ((float)shorter == (float)value)
            break;
    }
    return shorter;
}

/* The values in force, as many as the type has components, at most four. */
static uint32_t param_values(const struct pipeline *pipeline, const struct dt_param *param,
                             double values[4])
{
    uint32_t count = type_components(param->type);
    memcpy(values, param->value, sizeof param->value);
    if (param->live)
        live_get(pipeline->live, param, values);
    for (uint32_t i = 0; i < 4 && type_info(param->type)->scalar == DT_TYPE_FLOAT; i++)
        values[i] = shortest(values[i]);
    return count < 4 ? count : 4;
}

static cJSON *named(const char *name, const char *doc)
{
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "name", name);
    cJSON_AddStringToObject(item, "doc", doc ? doc : "");
    return item;
}

static cJSON *value_json(const struct dt_param *param, double value)
{
    return param->type == DT_TYPE_BOOL ? cJSON_CreateBool(value != 0) : cJSON_CreateNumber(value);
}

static cJSON *param_json(const struct pipeline *pipeline, const struct dt_param *param)
{
    cJSON *item = named(param->name, param->doc);
    double values[4];
    uint32_t count = param_values(pipeline, param, values);
    cJSON_AddStringToObject(item, "type", type_info(param->type)->name);
    cJSON_AddBoolToObject(item, "live", param->live);
    cJSON *list = count > 1 ? cJSON_AddArrayToObject(item, "value") : NULL;
    for (uint32_t i = 0; list && i < count; i++)
        cJSON_AddItemToArray(list, value_json(param, values[i]));
    if (!list)
        cJSON_AddItemToObject(item, "value", value_json(param, values[0]));
    if (isfinite(param->min))
        cJSON_AddNumberToObject(item, "min", param->min);
    if (isfinite(param->max))
        cJSON_AddNumberToObject(item, "max", param->max);
    if (param->step > 0)
        cJSON_AddNumberToObject(item, "step", param->step);
    return item;
}

/* As a dump's manifest describes it, under its name. */
static cJSON *resource_json(const struct dt_pipeline *info, uint32_t index, const uint32_t size[2])
{
    const struct dt_resource *resource = &info->resources[index];
    cJSON *item = named(resource->name, resource->doc);
    uint32_t extent[3];
    resource_extent(info, index, size, 0, extent);
    dump_describe(item, resource, 0, extent);
    cJSON_DeleteItemFromObject(item, "resource");
    cJSON_DeleteItemFromObject(item, "mip");
    if (resource->kind == DT_IMAGE) {
        cJSON_AddNumberToObject(item, "mips", resource->mips);
        cJSON_AddStringToObject(item, "shape", shape_name(resource->shape));
        cJSON_AddBoolToObject(item, "layered", resource->layered);
    }
    cJSON_AddBoolToObject(item, "history", resource->history);
    cJSON_AddBoolToObject(item, "input", resource->input);
    cJSON_AddStringToObject(item, "file", resource->file);
    return item;
}

static void add_names(cJSON *item, const char *key, const struct dt_pipeline *info,
                      const uint16_t *list, uint32_t count)
{
    cJSON *names = cJSON_AddArrayToObject(item, key);
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(names, cJSON_CreateString(info->resources[list[i]].name));
}

/* What it calls: the verb that draws or dispatches, and its arguments. */
static void add_call(cJSON *item, const struct dt_pipeline *info, const struct plan_work *work)
{
    char *kind = strdup(work->verb->name); /* "draw vertices" */
    for (char *at = kind; at && *at; at++)
        *at = (char)(*at == '_' ? ' ' : *at);
    cJSON_AddStringToObject(item, "kind", kind ? kind : "");
    free(kind);
    cJSON *arguments = cJSON_AddObjectToObject(item, "arguments");
    for (int i = 0; i < 4 && work->verb->arguments[i]; i++) {
        const char *name = work->verb->arguments[i];
        int64_t value = work->arguments[i];
        if (*name == '%')
            cJSON_AddStringToObject(arguments, name + 1,
                                    value < info->resource_count ? info->resources[value].name
                                                                 : "scene.indices");
        else
            cJSON_AddNumberToObject(arguments, name, (double)value);
    }
}

static cJSON *pass_json(const struct pipeline *pipeline, uint32_t index, const uint32_t size[2])
{
    const struct dt_pipeline *info = pipeline->info;
    const struct dt_pass *pass = &info->passes[index];
    struct plan_work work = plan_work(pipeline->plan, index, size, pipeline->live);
    cJSON *item = named(pass->name, pass->doc);
    add_call(item, info, &work);
    cJSON_AddStringToObject(item, "shader", pass->shader);
    add_names(item, "reads", info, pass->reads, pass->read_count);
    add_names(item, "writes", info, pass->writes, pass->write_count);
    return item;
}

cJSON *list_json(const struct pipeline *pipeline, const uint32_t size[2])
{
    const struct dt_pipeline *info = pipeline->info;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pipeline", info->name);
    cJSON_AddStringToObject(root, "doc", info->doc ? info->doc : "");
    cJSON_AddNumberToObject(root, "width", size[0]);
    cJSON_AddNumberToObject(root, "height", size[1]);
    cJSON *params = cJSON_AddArrayToObject(root, "params");
    for (uint32_t i = 0; i < info->param_count; i++)
        cJSON_AddItemToArray(params, param_json(pipeline, &info->params[i]));
    cJSON *resources = cJSON_AddArrayToObject(root, "resources");
    for (uint32_t i = 0; i < info->resource_count; i++)
        cJSON_AddItemToArray(resources, resource_json(info, i, size));
    cJSON *passes = cJSON_AddArrayToObject(root, "passes");
    for (uint32_t i = 0; i < info->pass_count; i++)
        cJSON_AddItemToArray(passes, pass_json(pipeline, i, size));
    cJSON *output = cJSON_AddObjectToObject(root, "output");
    if (info->linear_output >= 0)
        cJSON_AddStringToObject(output, "linear", info->resources[info->linear_output].name);
    if (info->display_output >= 0)
        cJSON_AddStringToObject(output, "display", info->resources[info->display_output].name);
    return root;
}
