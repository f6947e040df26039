/* From a spec and its --set overrides to a pipeline in memory: generated, compiled, cached by
 * content, loaded. Called by the verbs. */
#ifndef DIPTYCH_PIPELINE_H
#define DIPTYCH_PIPELINE_H

#include <dirent.h>

#include "base/console.h"
#include "base/options.h"
#include "base/tool.h"

/* A loaded pipeline. All pointers live until pipeline_unload. */
struct pipeline {
    const struct dt_pipeline *info;
    const struct dt_panel *gl, *vk;
    /* info->live_size bytes: the defaults with the live parameters that were set; owned */
    void *live;
    void *object; /* of dlopen */
    /* where it was generated: gl/PASS.comp, vk/PASS.comp and so on, and gen.d, which names the files
     * that it was made from; owned */
    char *generated;
    DIR *held;                        /* keeps that folder */
    double generator_ms, compiler_ms; /* that making it took; 0: it was in the cache */
    char *spec, *templates;           /* real paths of what it was generated from; owned */
};

/* The real path of a spec, NULL: of the project's own; logged; free(). */
char *pipeline_spec_path(const char *spec, const struct dt_log *log);

/* Generates, compiles and loads what is not in the cache yet: in build/cache beside the executable,
 * or in $XDG_CACHE_HOME/diptych when it is installed or that cannot be written. --set of a live parameter only writes
 * pipeline->live. On false the error is logged and nothing is left loaded. */
bool pipeline_load(struct pipeline *pipeline, struct console *console,
                   const struct options *options);
/* The same for a pipeline that will be edited: less is compiled at every edit, and frames may take longer. By a
 * generator that was prepared for it, in a hurry; NULL: none. */
bool pipeline_load_edited(struct pipeline *pipeline, struct console *console,
                          const struct options *options, struct tool_waiting *generator);
void pipeline_unload(struct pipeline *pipeline); /* takes a zeroed one */

#endif
