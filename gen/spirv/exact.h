/* Makes a module exact; see exact.c. */
#pragma once

#include "model/module.h"

/* Told of the form that an operation got: its place by OpLine, 0: none; the library's function without "exact_"; and
 * "FORM, of OPERANDS". */
typedef void tell_form_fn(void *user, uint32_t file, uint32_t line, const char *word,
                          const char *form);
/* tell: may be NULL. False when out of memory; the module is then empty or as it was. */
bool spirv_exact(struct spirv *module, tell_form_fn *tell, void *user);
