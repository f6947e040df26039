/* --variations: random valid variations of a spec. */
#ifndef DIPTYCH_GEN_VARY_H
#define DIPTYCH_GEN_VARY_H

#include "base/text.h"
#include "model/source.h"

struct vary_request {
    const char *spec, *templates_dir;
    const char *const *sets; /* apply to every variation; values that they set are not drawn */
    size_t set_count;
    uint32_t count;
    uint64_t seed;
    uint64_t bytes;      /* most that the resources of a variation may take together */
    const char *cache;   /* folder of compiled shaders; NULL: none */
    struct arena *arena; /* of the files that messages point into; of the caller */
};
/* `count` valid variations of a spec, as JSON; the same for the same seed on every machine. False when the
 * spec itself is wrong (reported) or a variation cannot be found. */
bool vary(const struct vary_request *request, struct text *out, struct diag *diag);

#endif
