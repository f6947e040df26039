/* The verbs of struct dt_verbs as data, from verbs.def: for the generator, the app and tests. Not
 * installed. */
#ifndef DIPTYCH_VERBS_H
#define DIPTYCH_VERBS_H

#include "panel.h"

enum dt_verb {
#define DT_VERB(ENUMERATOR, ...) DT_VERB_##ENUMERATOR,
#include "verbs.def"
    DT_VERBS
};

struct dt_verb_info {
    const char *name;         /* of the member of struct dt_verbs */
    const char *arguments[4]; /* NULL: no more */
};

static inline const struct dt_verb_info *dt_verb_info(enum dt_verb verb)
{
    static const struct dt_verb_info verbs[] = {
#define DT_VERB(ENUMERATOR, member, form, ...) {#member, {__VA_ARGS__}},
#include "verbs.def"
    };
    return &verbs[verb];
}

/* Calls the verb with as many of the arguments as it has. `list`: of the verb `barriers`. */
static inline bool dt_call(const struct dt_verbs *verbs, void *runtime, uint32_t pass,
                           enum dt_verb verb, const int64_t a[4], const struct dt_barrier *list)
{
#define ARGUMENTS_0
#define ARGUMENTS_1        , (uint32_t)a[0]
#define ARGUMENTS_2        ARGUMENTS_1, (uint32_t)a[1]
#define ARGUMENTS_3        ARGUMENTS_2, (uint32_t)a[2]
#define ARGUMENTS_FLAG     , a[0] != 0
#define ARGUMENTS_BARRIERS , list, (uint32_t)a[0]
#define ARGUMENTS_RECT     , dt_make_rect(a[0], a[1], a[2], a[3])
#define DT_VERB(ENUMERATOR, member, form, ...)                                                     \
    case DT_VERB_##ENUMERATOR:                                                                     \
        return verbs->member(runtime, pass ARGUMENTS_##form);
    switch (verb) {
#include "verbs.def"
    case DT_VERBS:
        break;
    }
    return false;
}

#endif
