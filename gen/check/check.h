/* All checks that need no plan. */
#pragma once

#include "model/source.h"

/* Resolves names and expressions, and reports all that is wrong with the model. templates_dir: folder for
 * shader bodies that are not in the spec's own folder. False when planning must not follow. */
bool check_model(struct model *model, const char *templates_dir, struct diag *diag);
/* check_names.c: whether a parameter or a resource can have the name. */
bool name_is_free(const char *name);
