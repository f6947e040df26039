/* Says what the pipeline is made of, and that no device is no device: a program that was generated,
 * compiled and linked by CMakeLists.txt or meson.build beside it. */
#include <stdio.h>

#include <diptych_vk.h>

#include "wave.h"

static void on_log(void *user, enum dt_level level, const char *message)
{
    (void)user, (void)level;
    printf("log: %s\n", message);
}

int main(void)
{
    const struct dt_vk_host nobody = {.log = {.message = on_log}};
    for (uint32_t i = 0; i < wave_pipeline.pass_count; i++)
        printf("pass %s, shader %s\n", wave_pipeline.passes[i].name,
               wave_pipeline.passes[i].shader);
    return dt_vk_open(&nobody) != NULL || wave_vk.panel != &wave_panel;
}
