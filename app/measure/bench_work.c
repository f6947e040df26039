/* Bytes and float operations of a pass; see bench_work.h. */
#include "measure/bench_work.h"

#include "console/texels.h"

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

/* All targets of a draw have one size. */
static double covered_texels(const struct work_frame *frame, const struct dt_pass *pass)
{
    for (uint32_t i = 0; i < pass->write_count; i++) {
        const struct dt_resource *target = &frame->pipeline->resources[pass->writes[i]];
        uint32_t extent[3];
        if (target->kind != DT_IMAGE)
            continue;
        resource_extent(frame->pipeline, pass->writes[i], frame->size,
                        pass->write_mips ? (uint32_t)__builtin_ctz(pass->write_mips[i]) : 0,
                        extent);
        return (double)resource_elements(target, extent);
    }
    return 0;
}

static double flops_of(const struct work_frame *frame, const struct dt_pass *pass)
{
    double runs =
        (double)frame->pipeline->runs(frame->pipeline, (uint32_t)(pass - frame->pipeline->passes),
                                      frame->size[0], frame->size[1], frame->live);
    if (pass->kind == DT_PASS_DISPATCH)
        return runs * (double)pass->flops[0];
    double corners = pass->kind == DT_PASS_DRAW_SCENE      ? frame->vertex_count
                     : pass->kind == DT_PASS_DRAW_VERTICES ? 1 /* `runs` counts them */
                                                           : 3;
    return runs * corners * (double)pass->flops[0] +
           covered_texels(frame, pass) * (double)pass->flops[1];
}

struct work work_of(const struct work_frame *frame, uint32_t index)
{
    const struct dt_pass *pass = &frame->pipeline->passes[index];
    struct work work = {.flops = flops_of(frame, pass)};
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
