/* `diptych list`: the parameters, resources and passes of a pipeline, as a table and as JSON. Opens no
 * backend. */
#include "spec/list.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "result/live.h"
#include "console/options.h"
#include "picture/texels.h"
#include "result/dump.h"
#include "verbs.h"

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

/* What a pass calls: the verb that draws or dispatches, and its arguments. */
struct call {
    const struct dt_verb_info *verb;
    char kind[32]; /* "draw vertices" */
    int64_t arguments[4];
    const char *names[4]; /* of arguments that are resources */
};

static struct call call_of(const struct pipeline *pipeline, uint32_t pass, const uint32_t size[2])
{
    struct call call = {0};
    const struct dt_pipeline *info = pipeline->info;
    call.verb = plan_work(pipeline->plan, pass, size, pipeline->live, call.arguments);
    for (size_t i = 0; call.verb->name[i] && i + 1 < sizeof call.kind; i++)
        call.kind[i] = (char)(call.verb->name[i] == '_' ? ' ' : call.verb->name[i]);
    for (int i = 0; i < 4 && call.verb->arguments[i]; i++)
        if (call.verb->arguments[i][0] == '%')
            call.names[i] = call.arguments[i] < info->resource_count
                                ? info->resources[call.arguments[i]].name
                                : "scene.indices";
    return call;
}

/* ---- Table ----------------------------------------------------------------------------------- */

/* A line of columns, without the blanks behind the last that holds something. */
static void print_line(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void print_line(const char *format, ...)
{
    char *line = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&line, format, arguments);
    va_end(arguments);
    if (length < 0)
        return;
    while (length > 0 && line[length - 1] == ' ')
        line[--length] = 0;
    puts(line);
    free(line);
}

static void print_value(const struct pipeline *pipeline, const struct dt_param *param, char *text,
                        size_t size)
{
    double values[4];
    uint32_t count = param_values(pipeline, param, values);
    size_t used = 0;
    for (uint32_t i = 0; i < count && used < size; i++) {
        const char *open = i ? ", " : count > 1 ? "[" : "";
        const char *close = i + 1 == count && count > 1 ? "]" : "";
        if (param->type == DT_TYPE_BOOL)
            used += (size_t)snprintf(text + used, size - used, "%s", values[i] ? "true" : "false");
        else
            used += (size_t)snprintf(text + used, size - used, "%s%.9g%s", open, values[i], close);
    }
}

static void print_params(const struct pipeline *pipeline, int width)
{
    const struct dt_pipeline *info = pipeline->info;
    printf("%u parameters\n", info->param_count);
    for (uint32_t i = 0; i < info->param_count; i++) {
        const struct dt_param *param = &info->params[i];
        char value[96] = "", range[64] = "";
        print_value(pipeline, param, value, sizeof value);
        if (isfinite(param->min) && isfinite(param->max))
            snprintf(range, sizeof range, "%.9g to %.9g", param->min, param->max);
        else if (isfinite(param->min))
            snprintf(range, sizeof range, "from %.9g", param->min);
        else if (isfinite(param->max))
            snprintf(range, sizeof range, "to %.9g", param->max);
        print_line("  %-*s  %-5s  %-9s  %-14s  %-4s  %s", width, param->name,
                   type_info(param->type)->name, value, range, param->live ? "live" : "",
                   param->doc ? param->doc : "");
    }
}

/* A struct's fields, or nothing for a buffer of a scalar or vector, which says its type itself. */
static void print_fields(const struct dt_resource *resource, int indent)
{
    if (resource->kind != DT_BUFFER || !resource->fields[0].name[0])
        return;
    printf("  %*s  {", indent, "");
    for (uint32_t i = 0; i < resource->field_count; i++) {
        const struct dt_field *field = &resource->fields[i];
        printf("%s%s: %s", i ? ", " : "", field->name, type_info(field->type)->name);
        if (field->array_count)
            printf("[%u]", field->array_count);
    }
    printf("}\n");
}

static void print_resources(const struct dt_pipeline *info, const uint32_t size[2], int width)
{
    printf("\n%u resources, at %ux%u\n", info->resource_count, size[0], size[1]);
    for (uint32_t i = 0; i < info->resource_count; i++) {
        const struct dt_resource *resource = &info->resources[i];
        bool buffer = resource->kind == DT_BUFFER;
        const char *type = !buffer ? format_info(resource->format)->name
                           : resource->fields[0].name[0]
                               ? "struct"
                               : type_info(resource->fields[0].type)->name;
        uint32_t extent[3];
        char shape[64];
        resource_extent(info, i, size, 0, extent);
        int used = buffer ? snprintf(shape, sizeof shape, "%u", extent[0])
                          : snprintf(shape, sizeof shape, "%ux%u", extent[0], extent[1]);
        if (resource->layered)
            used += snprintf(shape + used, sizeof shape - (size_t)used, "x%u", extent[2]);
        if (resource->mips > 1)
            snprintf(shape + used, sizeof shape - (size_t)used, ", %u mips", resource->mips);
        print_line("  %-*s  %-6s  %-10s  %-14s  %-7s  %s", width, resource->name,
                   buffer ? "buffer" : shape_name(resource->shape), type, shape,
                   resource->input     ? "input"
                   : resource->history ? "history"
                                       : "",
                   resource->doc ? resource->doc : "");
        print_fields(resource, width);
    }
}

static void print_names(const struct dt_pipeline *info, const char *head, const uint16_t *list,
                        uint32_t count, int indent)
{
    for (uint32_t i = 0; i < count; i++)
        if (i)
            printf(", %s", info->resources[list[i]].name);
        else
            printf("  %*s  %-6s %s", indent, "", head, info->resources[list[i]].name);
    if (count)
        printf("\n");
}

static void print_passes(const struct pipeline *pipeline, const uint32_t size[2], int width,
                         list_more *more, const void *user)
{
    const struct dt_pipeline *info = pipeline->info;
    printf("\n%u passes, in order of execution\n", info->pass_count);
    for (uint32_t i = 0; i < info->pass_count; i++) {
        const struct dt_pass *pass = &info->passes[i];
        struct call call = call_of(pipeline, i, size);
        char text[160];
        int used = snprintf(text, sizeof text, "%s", call.kind);
        for (int k = 0; k < 4 && call.verb->arguments[k] && used < (int)sizeof text; k++)
            used += call.names[k]
                        ? snprintf(text + used, sizeof text - (size_t)used, " %s", call.names[k])
                        : snprintf(text + used, sizeof text - (size_t)used, " %" PRId64,
                                   call.arguments[k]);
        print_line("  %-*s  %-24s  %-30s  %s", width, pass->name, text,
                   pass->shader ? pass->shader : "", pass->doc ? pass->doc : "");
        print_names(info, "reads", pass->reads, pass->read_count, width);
        print_names(info, "writes", pass->writes, pass->write_count, width);
        if (more)
            more(user, i, width);
    }
}

static int widest(int width, const char *name)
{
    return (int)strlen(name) > width ? (int)strlen(name) : width;
}

void list_print(const struct pipeline *pipeline, const uint32_t size[2], list_more *more,
                const void *user)
{
    const struct dt_pipeline *info = pipeline->info;
    int width = 0;
    for (uint32_t i = 0; i < info->param_count; i++)
        width = widest(width, info->params[i].name);
    for (uint32_t i = 0; i < info->resource_count; i++)
        width = widest(width, info->resources[i].name);
    for (uint32_t i = 0; i < info->pass_count; i++)
        width = widest(width, info->passes[i].name);
    bool told = info->doc && *info->doc;
    printf("%s%s%s\n\n", info->name, told ? ": " : "", told ? info->doc : "");
    print_params(pipeline, width);
    print_resources(info, size, width);
    print_passes(pipeline, size, width, more, user);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

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
    if (resource->file)
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

static cJSON *pass_json(const struct pipeline *pipeline, uint32_t index, const uint32_t size[2])
{
    const struct dt_pipeline *info = pipeline->info;
    const struct dt_pass *pass = &info->passes[index];
    struct call call = call_of(pipeline, index, size);
    cJSON *item = named(pass->name, pass->doc);
    cJSON_AddStringToObject(item, "kind", call.kind);
    cJSON *arguments = cJSON_AddObjectToObject(item, "arguments");
    for (int i = 0; i < 4 && call.verb->arguments[i]; i++)
        if (call.names[i])
            cJSON_AddStringToObject(arguments, call.verb->arguments[i] + 1, call.names[i]);
        else
            cJSON_AddNumberToObject(arguments, call.verb->arguments[i], (double)call.arguments[i]);
    if (pass->shader)
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
