/* Content from outside: the pictures and arrays that the spec (`file`) or --input names, as the
 * bytes that a runtime takes. */
#pragma once

#include "spec/pipeline.h"
#include "panel.h"

struct input {
    uint32_t resource, mips; /* a buffer has one */
    struct dt_bytes mip[DT_MAX_MIPS];
};

/* Reads the content of every input of the pipeline, pictures in a child process; pipeline_unload
 * frees it. With --input and without --size, the first input of --input that is an image as large
 * as the frame sets setup->size. With setup->inputs_later, inputs without a file are left out.
 * False: an error names the option, or the line of the spec. */
bool inputs_load(struct pipeline *pipeline, struct console *console, struct setup *setup);

/* The part of inputs_load that sets setup->size; reads no content. */
bool inputs_find_size(struct pipeline *pipeline, struct setup *setup, const struct dt_log *log);

/* Hands every input to a runtime, after its resize. For a pipeline without inputs_load, zeros: a
 * replay writes what its pass reads. */
bool inputs_write(const struct pipeline *pipeline, const struct dt_runtime *runtime, void *handle,
                  const uint32_t size[2]);
