/* Bytes of a pass; see bench_work.h. */
#include "measure/bench_work.h"

#include "picture/texels.h"

static double bytes_of(const struct work_frame *frame, uint32_t resource, uint32_t mips)
{
    const struct dt_resource *info = &frame->pipeline->resources[resource];
    double bytes = 0;
    for (uint32_t mip = 0; mips >> mip; mip++) {
        uint32_t extent[3];
        resource_extent(frame->pipeline, resource, frame->size, mip, extent);
        if (mips >> mip & 1)
            bytes += (double)resource_elements(info, extent) * resource_stride(info);
    }
    return bytes;
}

struct work work_of(const struct work_frame *frame, uint32_t index)
{
    const struct dt_pass *pass = &frame->pipeline->passes[index];
    struct work work = {0};
    for (uint32_t i = 0; i < pass->read_count; i++)
        work.read += bytes_of(frame, pass->reads[i],
                              resource_mips_before(frame->pipeline, index, pass->reads[i]));
    for (uint32_t i = 0; i < pass->write_count; i++)
        work.written +=
            bytes_of(frame, pass->writes[i], pass->write_mips ? pass->write_mips[i] : 1);
    if (pass->kind == DT_PASS_DRAW_SCENE)
        work.read += (double)frame->vertex_count * sizeof(struct dt_vertex) +
                     (double)frame->index_count * sizeof(uint32_t);
    return work;
}
