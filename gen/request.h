/* What load.h is asked for: the app hands it on as it is. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct diag;

struct spec_request {
    const char *path;
    const char *const *sets; /* "PATH=VALUE" */
    size_t set_count;
    const char *templates; /* folder with glsl/ */
    const char *root;      /* real path: files outside are not read; NULL: no limit */
    const char *cache;     /* folder of compiled shaders; NULL: none, every shader is compiled */
    struct diag *prove; /* --prove: gets a remark for the form of each operation; NULL: not given */
    bool exact_twin;    /* every pass is exact */
    bool gpu;           /* what `target: auto` is: the choices for GPUs, not for CPU drivers */
    bool text;          /* also OpenGL's GLSL */
    bool codes;         /* exact passes read the codes of sRGB textures: panel.h */
    unsigned sanitize;  /* mask of enum sanitize_kind; 0: off */
};
