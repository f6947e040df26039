/* Tries the faults of why_at.c, why_map.c and why_where.c on samples, and counts the best ones on all elements; see why.h. */
#include "theirs/why.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "theirs/why_fault.h"

enum { FEW = 4, GLANCE = 127, MOST_SAMPLES = 2048, MOST_COUNTED = 4 << 20 };
#define MOST_SLACK 14.0 /* codes: as steep as sRGB at black */

/* Beyond what two results that are equal but for rounding differ by. */
static double tolerance(const struct asked *asked, enum number_kind kind, double value, bool fine)
{
    if (number_is_integer(kind))
        return 0.001;
    if (number_one(kind))
        return (fine ? 0.25 : 1.01) / number_one(kind);
    double ulp = kind == NUMBER_FLOAT ? 0x1p-24 : kind == NUMBER_HALF ? 0x1p-11 : 0x1p-6;
    if (fine)
        return ulp * 0.25 * fabs(value);
    return kind == NUMBER_FLOAT ? 1e-5 * fabs(value) + 2e-6 * asked->range
                                : 3 * ulp * fabs(value) + ulp * 0.01 * asked->range;
}

struct trial {
    const struct fault *fault;
    const struct fault
        *inner;  /* a map of what `fault` gives, or an order of its channels; may be NULL */
    bool colour; /* a map leaves alpha as it is */
    int side;
    double p[FAULT_NUMBERS]; /* given or found */
    double cost;
    uint64_t after;
};

/* ---- One element ------------------------------------------------------------------------------- */

struct place place_of(const struct asked *asked, uint64_t element, uint32_t component)
{
    struct place place = {.element = element, .x = (int64_t)element, .component = component};
    uint64_t width = asked->to->extent[0], area = width * asked->to->extent[1];
    if (asked->image) {
        place.x = (int64_t)(element % width);
        place.y = (int64_t)(element % area / width);
        place.z = (int64_t)(element / area);
    }
    return place;
}

double copy_number(const struct asked *asked, const struct copy *copy, struct place place)
{
    int64_t width = copy->extent[0], height = asked->image ? copy->extent[1] : 1;
    int64_t depth = asked->image ? copy->extent[2] : 1;
    if (place.x < 0 || place.x >= width || place.y < 0 || place.y >= height || place.z < 0 ||
        place.z >= depth || !copy->data)
        return NAN;
    uint64_t element = (uint64_t)((place.z * height + place.y) * width + place.x);
    const struct component *component = &asked->components[place.component];
    return number_value(component->kind, copy->data + element * asked->stride + component->offset);
}

double from_at(const struct asked *asked, struct place place, int64_t x, int64_t y, int64_t z,
               uint32_t component)
{
    place.x = x;
    place.y = y;
    place.z = z;
    place.component = component;
    return copy_number(asked, asked->from, place);
}

double same_from(const struct asked *asked, struct place place, uint32_t component)
{
    return from_at(asked, place, place.x, place.y, place.z, component);
}

double to_number(const struct asked *asked, struct place place)
{
    return copy_number(asked, asked->to, place);
}

/* What the fault makes of `from`. *slack: how far a code's rounding carries. */
static double predict(const struct asked *asked, const struct trial *trial, struct place place,
                      double *slack)
{
    const struct fault *fault = trial->fault, *map = trial->inner;
    bool kept = trial->colour && place.component == 3;
    if (map && map->channels) {
        if (!(map->p[place.component % FAULT_NUMBERS] < asked->count))
            return NAN;
        place.component = (uint32_t)map->p[place.component % FAULT_NUMBERS];
        map = NULL;
    }
    double value = fault->at ? fault->at(asked, place) : copy_number(asked, asked->from, place);
    uint32_t one = number_one(asked->components[place.component].kind);
    *slack = 0;
    map = map ? map : fault->map ? fault : NULL;
    if (!map || kept)
        return value;
    const double *p = map == fault ? asked->p : map->p;
    double step = one ? 0.5 / one : fabs(value) * 0x1p-23;
    *slack = fabs(map->map(p, value + step) - map->map(p, value - step));
    *slack = fmin(*slack, one ? MOST_SLACK / one : 1e-3 * asked->range);
    return map->map(p, value);
}

/* As far as the format holds it. */
static double clamped(enum number_kind kind, double value)
{
    if (number_one(kind))
        return fmin(fmax(value, kind == NUMBER_SNORM16 ? -1 : 0), 1);
    return value;
}

/* Whether the element is still wrong; adds its error. Unknown numbers count in *unknown. */
static bool is_wrong(const struct asked *asked, const struct trial *trial, uint64_t element,
                     bool fine, double *error, uint32_t *unknown)
{
    bool wrong = false, known = false;
    for (uint32_t c = 0; c < asked->count; c++) {
        struct place place = place_of(asked, element, c);
        enum number_kind kind = asked->components[c].kind;
        double slack = 0, got = copy_number(asked, asked->to, place), want;
        if (trial)
            want = predict(asked, trial, place, &slack);
        else
            want = copy_number(asked, asked->from, place);
        if (isnan(want) && trial)
            continue;
        want = clamped(kind, want);
        known = true;
        double apart = fabs(want - got);
        if (!(apart <= 50 * asked->range))
            apart = 50 * asked->range;
        *error += apart;
        wrong |= !(fabs(want - got) <= tolerance(asked, kind, got, fine) + slack) && want != got;
    }
    *unknown += !known;
    return wrong;
}

/* ---- One fault --------------------------------------------------------------------------------- */

struct tally {
    uint64_t before, elements; /* of all */
    bool fine;
    bool few;         /* less than FEW numbers differ */
    bool constant[2]; /* nearly all differing elements of that copy have the same numbers */
    double error;     /* of the differing samples without a fault */
    double glance;    /* the same of the first of them */
};

static void try_where(const struct asked *asked, struct trial *trial, const struct tally *tally)
{
    uint32_t outside = 0, inside = 0;
    for (uint32_t i = 0; i < asked->differing_count; i++)
        outside += !trial->fault->where(asked, place_of(asked, asked->differing[i], 0));
    for (uint32_t i = 0; i < asked->all_count; i++)
        inside += trial->fault->where(asked, place_of(asked, asked->all[i], 0));
    double left = (double)outside / asked->differing_count;
    double share = (double)inside / asked->all_count;
    trial->after = (uint64_t)ceil(left * (double)tally->before);
    trial->cost =
        4 * left + 0.3 * share + 0.05; /* little is said by a place where most elements are */
    if (left > 0.02 || share > 0.6)
        trial->cost = 9;
}

static void try_values(const struct asked *asked, struct trial *trial, const struct tally *tally)
{
    uint32_t wrong = 0, broken = 0, unknown = 0, ignored = 0;
    double error = 0, other = 0;
    for (uint32_t i = 0; i < asked->differing_count; i++) {
        wrong += is_wrong(asked, trial, asked->differing[i], tally->fine, &error, &unknown);
        if (i == GLANCE && wrong + unknown > i && error > tally->glance * 0.7) {
            trial->cost = 9; /* most faults are far off */
            return;
        }
    }
    if (unknown > asked->differing_count / 4 * 3) {
        trial->cost = 9;
        return;
    }
    double left = (double)wrong / (asked->differing_count - unknown);
    if (left < 0.9 || error < tally->error / 2)
        for (uint32_t i = 0; i < asked->all_count; i++)
            broken += is_wrong(asked, trial, asked->all[i], tally->fine, &other, &ignored);
    double all = (double)broken / asked->all_count * (double)tally->elements;
    double still = fmax(all, left * (double)tally->before);
    double nearer = tally->error > 0 ? error / tally->error : 0;
    trial->after = (uint64_t)ceil(still);
    trial->cost = 0.6 * still / (double)tally->before + 0.4 * nearer;
    trial->cost += 0.05 * unknown / asked->differing_count;
}

static void set_side(struct asked *asked, int side)
{
    asked->side = side;
    asked->from = &asked->copies[side];
    asked->to = &asked->copies[!side];
}

static void run_trial(struct asked *asked, struct trial *trial, const struct tally *tally)
{
    const struct fault *fault = trial->fault;
    trial->cost = 9;
    set_side(asked, trial->side);
    memcpy(asked->p, fault->p, sizeof asked->p);
    if ((fault->applies && !fault->applies(asked)) ||
        (trial->inner && trial->inner->applies && !trial->inner->applies(asked)) ||
        (fault->fit && !fault->fit(asked)))
        return;
    if (!fault->share && tally->few)
        return; /* much explains a number or two */
    if (!fault->share && !fault->where && tally->constant[!trial->side])
        return; /* and one value everywhere */
    memcpy(trial->p, asked->p, sizeof trial->p);
    if (fault->where) {
        try_where(asked, trial, tally);
    } else if (fault->share) {
        double left = fault->share(asked);
        trial->after = (uint64_t)ceil(left * (double)tally->before);
        trial->cost = left > 0.05 ? 9 : left;
    } else {
        try_values(asked, trial, tally);
    }
    trial->cost += fault->doubt + (trial->inner ? trial->inner->doubt + 0.04 : 0);
}

/* ---- All faults -------------------------------------------------------------------------------- */

/* Keeps the cheapest; of one fault the better side. */
static void keep_best(struct trial best[WHY_MOST], const struct trial *trial)
{
    int at = 0;
    if (!(trial->cost < 0.75))
        return;
    for (int i = 0; i < WHY_MOST; i++)
        if (best[i].fault == trial->fault && best[i].inner == trial->inner) {
            if (best[i].cost <= trial->cost)
                return;
            memmove(&best[i], &best[i + 1], (size_t)(WHY_MOST - 1 - i) * sizeof *best);
            best[WHY_MOST - 1] = (struct trial){0};
            break;
        }
    while (at < WHY_MOST && best[at].fault && best[at].cost <= trial->cost)
        at++;
    if (at == WHY_MOST)
        return;
    memmove(&best[at + 1], &best[at], (size_t)(WHY_MOST - 1 - at) * sizeof *best);
    best[at] = *trial;
}

/* With and without alpha, which colour spaces and exposures leave alone. */
static void try_both(struct asked *asked, struct trial best[WHY_MOST], struct trial *trial,
                     const struct tally *tally)
{
    bool map = trial->fault->map || (trial->inner && trial->inner->map);
    for (int colour = 0; colour < (map && asked->image && asked->count == 4 ? 2 : 1); colour++) {
        trial->colour = colour;
        run_trial(asked, trial, tally);
        keep_best(best, trial);
    }
}

static bool is_inner(const struct fault *fault)
{
    return (fault->map && !fault->fit) || fault->channels;
}

static void try_list(struct asked *asked, struct trial best[WHY_MOST], const struct tally *tally,
                     const struct fault_list *faults)
{
    for (uint32_t i = 0; i < faults->count; i++)
        for (int side = 0; side < (faults->list[i].symmetric ? 1 : 2); side++) {
            struct trial trial = {.fault = &faults->list[i], .side = side};
            try_both(asked, best, &trial, tally);
        }
}

/* All of place with those of a list. */
static void try_pairs_with(struct asked *asked, struct trial best[WHY_MOST],
                           const struct tally *tally, const struct fault_list *inner)
{
    for (uint32_t i = 0; i < faults_at.count; i++) {
        const struct fault *fault = &faults_at.list[i];
        for (uint32_t k = 0; !fault->fit && !fault->channels && k < inner->count; k++)
            for (int side = 0; is_inner(&inner->list[k]) && side < 2; side++) {
                struct trial trial = {.fault = fault, .inner = &inner->list[k], .side = side};
                try_both(asked, best, &trial, tally);
            }
    }
}

/* ---- Samples ----------------------------------------------------------------------------------- */

/* One in `one_in`, a power of two, without a rhythm that tiles could have. */
static bool is_sampled(uint64_t element, uint64_t one_in)
{
    return !((element * 0x9e3779b97f4a7c15u >> 40) & (one_in - 1));
}

/* Differing elements, at most MOST_SAMPLES. Returns how many there are, of MOST_COUNTED evenly spread. */
static uint64_t sample_differing(struct asked *asked, uint64_t elements, bool fine,
                                 uint64_t *samples)
{
    uint64_t step = (elements / MOST_COUNTED + 1) | 1, found = 0, one_in = 1;
    uint32_t unknown = 0, count = 0;
    double error = 0;
    for (uint64_t i = 0; i < elements; i += step) {
        if (!is_wrong(asked, NULL, i, fine, &error, &unknown))
            continue;
        found++;
        while (count == MOST_SAMPLES) {
            uint32_t kept = 0;
            one_in *= 2;
            for (uint32_t k = 0; k < count; k++)
                if (is_sampled(samples[k], one_in))
                    samples[kept++] = samples[k];
            count = kept;
        }
        if (is_sampled(i, one_in))
            samples[count++] = i;
    }
    asked->differing_count = count;
    return found * step < elements ? found * step : elements;
}

static void shuffle(uint64_t *samples, uint32_t count)
{
    uint64_t state = 1;
    for (uint32_t i = count; i-- > 1;) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        uint32_t other = (uint32_t)((state >> 33) % (i + 1));
        uint64_t kept = samples[i];
        samples[i] = samples[other];
        samples[other] = kept;
    }
}

static void sample_all(struct asked *asked, uint64_t elements, uint64_t *samples)
{
    uint64_t state = 1;
    asked->all_count = 0;
    for (uint64_t i = 0; i < MOST_SAMPLES; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        samples[asked->all_count++] =
            elements <= MOST_SAMPLES ? i % elements : (state >> 20) % elements;
    }
}

/* Of the differing samples, at least nine of ten as the first or the last. */
static bool copy_is_constant(const struct asked *asked, const struct copy *copy)
{
    uint32_t count = asked->differing_count, like[2] = {0};
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < count; i++) {
            uint64_t pattern = asked->differing[k ? count - 1 : 0];
            bool same = true;
            for (uint32_t c = 0; c < asked->count && same; c++)
                same = copy_number(asked, copy, place_of(asked, pattern, c)) ==
                       copy_number(asked, copy, place_of(asked, asked->differing[i], c));
            like[k] += same;
        }
    return count > 1 && (like[0] * 10 > count * 9 || like[1] * 10 > count * 9);
}

/* Of the differing samples. */
static uint32_t differing_numbers(const struct asked *asked)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < asked->differing_count; i++)
        for (uint32_t c = 0; c < asked->count; c++) {
            struct place place = place_of(asked, asked->differing[i], c);
            count += copy_number(asked, asked->from, place) != copy_number(asked, asked->to, place);
        }
    return count;
}

static void measure_range(struct asked *asked)
{
    double sum = 0;
    uint64_t count = 0;
    for (uint32_t i = 0; i < asked->all_count; i++)
        for (uint32_t c = 0; c < asked->count; c++) {
            double value = copy_number(asked, asked->from, place_of(asked, asked->all[i], c));
            if (isfinite(value) && fabs(value) < 1e30) {
                sum += fabs(value);
                count++;
            }
        }
    asked->range = count && sum > 0 ? sum / (double)count : 1;
}

/* ---- Components -------------------------------------------------------------------------------- */

/* An artificial fourth channel tells nothing. */
static bool has_constant_alpha(const struct asked *asked)
{
    for (int i = 0; i < 2; i++)
        for (uint32_t k = 0; k < asked->all_count; k++)
            if (copy_number(asked, &asked->copies[i], place_of(asked, asked->all[k], 3)) != 1)
                return false;
    return true;
}

static void find_transposed(const struct asked *asked, uint32_t *transposed)
{
    const struct dt_resource *resource = asked->resource;
    uint32_t at = 0;
    for (uint32_t c = 0; c < asked->count; c++)
        transposed[c] = c;
    for (uint32_t i = 0; !asked->image && i < resource->field_count; i++) {
        const struct dt_field *field = &resource->fields[i];
        uint32_t each = type_components(field->type);
        uint32_t items = field->array_count ? field->array_count : 1;
        if (each == 1 && (items == 9 || items == 16)) {
            each = items;
            items = 1;
        }
        uint32_t side = each == 16 ? 4 : each == 9 ? 3 : 0;
        for (uint32_t k = 0; k < items * each && side; k++)
            transposed[at + k] = at + k / each * each + k % side * side + k % each / side;
        at += each * items;
    }
}

/* ---- Words ------------------------------------------------------------------------------------- */

static void write_slot(FILE *out, const char *slot, const struct why_question *question,
                       const struct trial *trial)
{
    if (!strncmp(slot, "from}", 5))
        fputs(question->labels[trial->side], out);
    else if (!strncmp(slot, "to}", 3))
        fputs(question->labels[!trial->side], out);
    else
        fprintf(out, "%.6g", trial->p[(*slot - '0') % FAULT_NUMBERS]);
}

static void write_text(FILE *out, const char *text, const struct why_question *question,
                       const struct trial *trial)
{
    for (; *text; text++)
        if (*text == '{') {
            write_slot(out, text + 1, question, trial);
            text += strcspn(text, "}");
        } else {
            fputc(*text, out);
        }
}

static char *describe_trial(const struct asked *asked, const struct why_question *question,
                            const struct trial *trial, const struct tally *tally)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    bool place = trial->fault->where || trial->fault->share;
    bool code = number_one(asked->components[0].kind) && !tally->fine;
    if (!out)
        return NULL;
    if (place)
        fputs("differs ", out);
    else if (!trial->after)
        fputs(code ? "equal (to a code) " : "equal ", out);
    else
        fputs(trial->after * 20 < tally->before ? "nearly equal " : "far nearer ", out);
    write_text(out, trial->fault->text, question, trial);
    if (trial->inner) {
        fputs(", and ", out);
        write_text(out, trial->inner->text, question, trial);
    }
    fprintf(out, " (%llu %s before, %llu %s)", (unsigned long long)tally->before,
            tally->before == 1 ? "differs" : "differ", (unsigned long long)trial->after,
            place ? "elsewhere" : "after");
    return fclose(out) == 0 ? text : NULL;
}

/* Samples may miss a few: what the fault leaves of all elements. */
static uint64_t count_left(struct asked *asked, const struct trial *trial,
                           const struct tally *tally)
{
    uint64_t step = (tally->elements / MOST_COUNTED + 1) | 1, left = 0;
    uint32_t unknown = 0;
    double error = 0;
    if (trial->fault->share)
        return trial->after;
    set_side(asked, trial->side);
    memcpy(asked->p, trial->p, sizeof asked->p);
    for (uint64_t i = 0; i < tally->elements; i += step) {
        const struct trial *taken = trial->fault->where ? NULL : trial;
        bool wrong = is_wrong(asked, taken, i, tally->fine, &error, &unknown);
        left += wrong && (taken || !trial->fault->where(asked, place_of(asked, i, 0)));
    }
    return left * step;
}

static bool tell_reason(struct why *why, struct asked *asked, const struct why_question *question,
                        struct trial *best, const struct tally *tally)
{
    for (int i = 0; i < WHY_MOST && best[i].fault; i++) {
        if (i && best[i].cost > 0.05 + 1.3 * best[0].cost)
            break;
        if (i && !strcmp(best[i].fault->name, best[0].fault->name))
            continue; /* the same from the other copy */
        best[i].after = count_left(asked, &best[i], tally);
        if (best[i].after > tally->before)
            continue; /* nearer by its numbers, but not by their count: no cause */
        struct why_reason *reason = &why->reasons[why->count];
        *reason = (struct why_reason){.name = best[i].fault->name,
                                      .text = describe_trial(asked, question, &best[i], tally),
                                      .before = tally->before,
                                      .after = best[i].after};
        if (!reason->text)
            return false;
        why->count++;
    }
    return true;
}

/* ---- The question ------------------------------------------------------------------------------ */

static bool look(struct why *why, struct asked *asked, const struct why_question *question,
                 uint64_t *samples)
{
    struct trial best[WHY_MOST] = {{0}};
    struct tally tally = {.elements =
                              resource_elements(asked->resource, question->copies[0].extent)};
    uint32_t unknown = 0;
    sample_all(asked, tally.elements, samples + MOST_SAMPLES);
    if (asked->image && asked->count == 4 && has_constant_alpha(asked))
        asked->count = 3;
    measure_range(asked);
    tally.before = sample_differing(asked, tally.elements, false, samples);
    tally.fine = !tally.before;
    if (tally.fine)
        tally.before = sample_differing(asked, tally.elements, true, samples);
    if (!tally.before)
        return true;
    shuffle(samples, asked->differing_count);
    for (uint32_t i = 0; i < asked->differing_count; i++) {
        is_wrong(asked, NULL, asked->differing[i], tally.fine, &tally.error, &unknown);
        if (i <= GLANCE)
            tally.glance = tally.error;
    }
    tally.few = differing_numbers(asked) < FEW;
    for (int i = 0; i < 2; i++)
        tally.constant[i] = copy_is_constant(asked, &asked->copies[i]);
    try_list(asked, best, &tally, &faults_at);
    try_list(asked, best, &tally, &faults_map);
    try_list(asked, best, &tally, &faults_where);
    /* a fault of place and one of value together, where none alone is enough */
    if (!tally.few && (!best[0].fault || best[0].cost > 0.15)) {
        try_pairs_with(asked, best, &tally, &faults_at);
        try_pairs_with(asked, best, &tally, &faults_map);
    }
    return tell_reason(why, asked, question, best, &tally);
}

static void load_relatives(struct asked *asked, const struct why_question *question)
{
    for (int side = 0; side < 2 && question->relative; side++)
        for (int i = 0; i < WHY_RELATIVES; i++) {
            struct dt_bytes bytes = {0};
            struct copy *copy = &asked->relatives[side][i];
            if (!question->relative(question->user, (enum why_relative)i, side, &bytes))
                continue;
            *copy = (struct copy){.data = bytes.data, .size = bytes.size};
            memcpy(copy->extent, bytes.extent, sizeof copy->extent);
        }
}

bool why_find(struct why *why, const struct why_question *question)
{
    struct component *components = NULL;
    struct asked asked = {.resource = question->resource,
                          .image = question->resource->kind == DT_IMAGE,
                          .stride = resource_stride(question->resource)};
    asked.count = resource_components(question->resource, &components);
    uint64_t *samples = calloc(2 * MOST_SAMPLES, sizeof *samples);
    uint32_t *transposed = calloc(asked.count + 1, sizeof *transposed);
    bool good = asked.count && samples && transposed;
    *why = (struct why){0};
    asked.components = components;
    asked.transposed = transposed;
    asked.differing = samples;
    asked.all = samples ? samples + MOST_SAMPLES : NULL;
    for (int i = 0; i < 2; i++) {
        const struct dt_bytes *bytes = &question->copies[i];
        asked.copies[i] = (struct copy){.data = bytes->data, .size = bytes->size};
        memcpy(asked.copies[i].extent, bytes->extent, sizeof bytes->extent);
    }
    set_side(&asked, 0);
    if (good) {
        find_transposed(&asked, transposed);
        load_relatives(&asked, question);
        good = look(why, &asked, question, samples);
    }
    for (int i = 0; i < 2 * WHY_RELATIVES; i++)
        free(asked.relatives[i / WHY_RELATIVES][i % WHY_RELATIVES].data);
    free(components);
    free(samples);
    free(transposed);
    return good;
}

void why_json(cJSON *root, const struct why *why)
{
    cJSON *list = cJSON_AddArrayToObject(root, "why");
    for (uint32_t i = 0; i < why->count; i++) {
        const struct why_reason *reason = &why->reasons[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", reason->name);
        cJSON_AddStringToObject(item, "text", reason->text);
        cJSON_AddNumberToObject(item, "before", (double)reason->before);
        cJSON_AddNumberToObject(item, "after", (double)reason->after);
        cJSON_AddItemToArray(list, item);
    }
}

void why_free(struct why *why)
{
    for (uint32_t i = 0; i < why->count; i++)
        free(why->reasons[i].text);
    *why = (struct why){0};
}
