/* Kinds of undefined behaviour that --sanitize looks for and `allow` of a pass silences. */
#pragma once

enum sanitize_kind { /* masks */
                     SANITIZE_INDEX = 1 << 0,
                     SANITIZE_ARITHMETIC = 1 << 1,
                     SANITIZE_LOOP = 1 << 2,
                     SANITIZE_VARIABLE = 1 << 3,
                     SANITIZE_CONTENT = 1 << 4,
                     SANITIZE_RACE = 1 << 5,
                     SANITIZE_FLOW = 1 << 6,
                     SANITIZE_SHADOW = SANITIZE_CONTENT | SANITIZE_RACE | SANITIZE_FLOW,
                     SANITIZE_ALL = (1 << 7) - 1
};
enum { /* most internal resources of a pipeline, and accesses of a pass to them: plan/sanitize.c, shadow.c */
       SANITIZE_RESOURCES = 5,
       SANITIZE_ACCESSES = 4
};
/* The mask of a list like "index,loop"; "" is all. 0: *end is where the unknown word begins. */
unsigned sanitize_kinds(const char *list, const char **end);
#define SANITIZE_WORDS "index, arithmetic, loop, variable, content, race, flow"
/* Of a mask with one kind. */
const char *sanitize_kind_name(unsigned kind);
