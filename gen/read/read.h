/* YAML -> model. Names are strings still; every node knows its place in the source. */
#pragma once

#include "model/source.h"

/* sets: "PATH=VALUE" strings that override values of the document. False: errors are in diag. */
bool read_spec(struct model *model, const char *path, const char *const *sets, size_t set_count,
               struct diag *diag);
