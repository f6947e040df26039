/* All shaders of a pipeline: every pass, backend and stage to GLSL and SPIR-V. Called by main.c, which
 * writes them, and by vary.c, which asks whether they compile. */
#include <stdlib.h>

#include "stages.h"

static bool has_stage(const struct pass *pass, enum stage stage)
{
    return pass->kind == PASS_DISPATCH ? stage == STAGE_IS_COMPUTE : stage != STAGE_IS_COMPUTE;
}

static bool compile_pass(struct model *model, struct pass_shaders *shaders, enum backend backend,
                         const struct pass *pass, struct diag *diag)
{
    bool good = true;
    for (enum stage stage = STAGE_IS_COMPUTE; stage <= STAGE_IS_FRAGMENT; stage++) {
        struct shader *shader = &shaders->stage[stage];
        shader->stage = stage;
        if (has_stage(pass, stage))
            good &= emit_glsl(model, pass, backend, stage, shader, diag) &&
                    spirv_compile(model, pass, backend, shader, diag);
    }
    return good;
}

bool shaders_compile(struct model *model, struct pass_shaders *shaders[2], struct diag *diag)
{
    uint32_t count = model->pipeline.pass_count;
    if (!spirv_init()) {
        diag_error(diag, (struct loc){0}, "the GLSL compiler could not be started");
        return false;
    }
    bool good = true;
    for (enum backend backend = BACKEND_GL; backend <= BACKEND_VK; backend++) {
        shaders[backend] = calloc(count + 1, sizeof *shaders[backend]);
        if (!shaders[backend])
            diag_error(diag, (struct loc){0}, "out of memory");
        for (uint32_t i = 0; shaders[backend] && i < count; i++)
            good &=
                compile_pass(model, &shaders[backend][i], backend, model->pipeline.order[i], diag);
        good &= shaders[backend] != NULL;
    }
    spirv_finish();
    return good && !diag_error_count(diag);
}

void shaders_free(const struct model *model, struct pass_shaders *shaders[2])
{
    for (int backend = 0; backend < 2; backend++) {
        for (uint32_t i = 0; shaders[backend] && i < model->pipeline.pass_count; i++)
            for (int stage = 0; stage < 3; stage++) {
                text_free(&shaders[backend][i].stage[stage].glsl);
                free(shaders[backend][i].stage[stage].words);
            }
        free(shaders[backend]);
        shaders[backend] = NULL;
    }
}
