/* The pass `painted` of work.yaml in C, for bench_test.sh: a diagonal matrix scales the texel's place.
 * With the parameter `spare` it does other work. */
#include "limit.h"
#include "work.h"

const struct dt_limit_tolerance limit_painted_tolerance = {.relative = 0.001, .outliers = 0};

void limit_painted(const struct dt_limit *limit)
{
    const struct work_live *live = limit->live;
    struct dt_bytes *sheet = &limit->outputs[WORK_RESOURCE_SHEET];
    _Float16 *texels = (void *)sheet->data;
    for (uint32_t y = 0; y < sheet->extent[1]; y++)
        for (uint32_t x = 0; x < sheet->extent[0]; x++, texels += 2) {
            texels[0] = (_Float16)(live->shift * (float)x);
            texels[1] = (_Float16)(live->shift * (float)(y + WORK_PARAM_SPARE));
        }
}
