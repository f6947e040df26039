/* Live parameters by name and as text; see live.h. */
#include "result/live.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "picture/texels.h"

const struct dt_param *live_param(const struct dt_pipeline *info, const char *name)
{
    for (uint32_t i = 0; i < info->param_count; i++)
        if (strcmp(info->params[i].name, name) == 0)
            return &info->params[i];
    return NULL;
}

/* Reads "1.5", "true" or "[1, 2]" into values; false unless it is exactly `count` of them. */
static bool read_live_values(const char *text, uint32_t count, double *values)
{
    bool list = *text == '[';
    const char *at = list ? text + 1 : text;
    for (uint32_t i = 0; i < count; i++) {
        at += strspn(at, " ");
        char *end = NULL;
        values[i] = strtod(at, &end);
        if (end == at && strncmp(at, "true", 4) == 0) {
            values[i] = 1;
            end += 4;
        } else if (end == at && strncmp(at, "false", 5) == 0) {
            values[i] = 0;
            end += 5;
        }
        if (end == at || !isfinite(values[i]))
            return false;
        at = end + strspn(end, " ");
        if (i + 1 < count && *at++ != ',')
            return false;
    }
    if (list && *at++ != ']')
        return false;
    return *at == 0 && (list || count == 1);
}

static bool fits(const struct dt_param *param, enum dt_type scalar, double value)
{
    if (value < param->min || value > param->max)
        return false;
    if (scalar == DT_TYPE_INT)
        return value == floor(value) && value >= INT32_MIN && value <= INT32_MAX;
    if (scalar == DT_TYPE_UINT)
        return value == floor(value) && value >= 0 && value <= UINT32_MAX;
    return scalar == DT_TYPE_BOOL ? value == 0 || value == 1 : fabs(value) <= FLT_MAX;
}

static void write_scalar(uint8_t *place, enum dt_type scalar, double value)
{
    float number = (float)value;
    int32_t whole = scalar == DT_TYPE_INT ? (int32_t)value : 0;
    uint32_t natural = scalar == DT_TYPE_UINT || scalar == DT_TYPE_BOOL ? (uint32_t)value : 0;
    if (scalar == DT_TYPE_FLOAT)
        memcpy(place, &number, sizeof number);
    else if (scalar == DT_TYPE_INT)
        memcpy(place, &whole, sizeof whole);
    else
        memcpy(place, &natural, sizeof natural);
}

bool live_set(const struct dt_pipeline *info, void *live, const struct dt_param *param,
              const char *value, const struct dt_log *log)
{
    enum dt_type scalar = type_info(param->type)->scalar;
    uint32_t count = type_components(param->type);
    double values[16];
    if (count > 4 || param->offset + count * 4 > info->live_size ||
        !read_live_values(value, count, values))
        return report_error(log, "--set %s=%s: must be %s%s", param->name, value,
                            count > 1 ? "a list like [1, 2] of type " : "of type ",
                            type_info(param->type)->name);
    for (uint32_t i = 0; i < count; i++) {
        if (!fits(param, scalar, values[i]))
            return report_error(log, "--set %s=%s: must be of type %s, from %g to %g", param->name,
                                value, type_info(param->type)->name, param->min, param->max);
    }
    for (uint32_t i = 0; i < count; i++)
        write_scalar((uint8_t *)live + param->offset + i * 4, scalar, values[i]);
    return true;
}

void live_get(const void *live, const struct dt_param *param, double values[4])
{
    static const enum number_kind kinds[] = {[DT_TYPE_FLOAT] = NUMBER_FLOAT,
                                             [DT_TYPE_INT] = NUMBER_INT,
                                             [DT_TYPE_UINT] = NUMBER_UINT,
                                             [DT_TYPE_BOOL] = NUMBER_UINT};
    const uint8_t *place = (const uint8_t *)live + param->offset;
    for (uint32_t i = 0; i < type_components(param->type) && i < 4; i++)
        values[i] = number_value(kinds[type_info(param->type)->scalar], place + i * 4);
}
