/* Reads what a dump of anybody's renderer says of itself; see theirs.h. */
#include "theirs/theirs.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "base/foreign.h"
#include "base/printable.h"
#include "formats.h"

enum {
    MOST_EXTENT = 1 << 24,
    MOST_FIELDS = 256,
    MOST_STRIDE = 65536,
    MOST_ENTRIES = 10000,
    MOST_SAMPLES = 64
};
#define MOST_BYTES ((uint64_t)4 << 30)

static struct their_entry *add_their_entry(struct theirs *theirs)
{
    struct their_entry *list = realloc(theirs->entries, (theirs->count + 1) * sizeof *list);
    if (!list) {
        report_error(theirs->log, "out of memory");
        return NULL;
    }
    theirs->entries = list;
    list[theirs->count] = (struct their_entry){0};
    return &list[theirs->count++];
}

/* ---- A manifest ------------------------------------------------------------------------------ */

static const char *their_text(const cJSON *object, const char *key)
{
    return cJSON_GetStringValue(cJSON_GetObjectItem(object, key));
}

static bool wrong(const struct theirs *theirs, const struct their_entry *entry, const char *key,
                  const char *what)
{
    return report_error(theirs->log, "%s/manifest.json: entry %td: \"%s\" %s", theirs->folder,
                        entry - theirs->entries, key, what);
}

/* A whole number from `least` to `most`, or `otherwise` where the key is missing. */
static bool take_number(const struct theirs *theirs, const struct their_entry *entry,
                        const cJSON *object, const char *key, uint32_t least, uint32_t most,
                        uint32_t *number)
{
    const cJSON *item = cJSON_GetObjectItem(object, key);
    double value = cJSON_GetNumberValue(item);
    char text[80];
    if (!item && *number >= least)
        return true;
    if (cJSON_IsNumber(item) && value >= least && value <= most && value == floor(value)) {
        *number = (uint32_t)value;
        return true;
    }
    snprintf(text, sizeof text, "is not a whole number from %u to %u", least, most);
    return wrong(theirs, entry, key, text);
}

static bool find_type(const char *name, enum dt_type *type)
{
    for (int i = 0; i < DT_TYPE_COUNT; i++)
        if (name && !strcmp(name, type_info((enum dt_type)i)->name)) {
            *type = (enum dt_type)i;
            return true;
        }
    return false;
}

static bool take_field(const struct theirs *theirs, const struct their_entry *entry,
                       const cJSON *item, struct dt_field *field)
{
    field->name = their_text(item, "name");
    if (!field->name)
        return wrong(theirs, entry, "name", "of a field is missing");
    if (!find_type(their_text(item, "type"), &field->type))
        return wrong(theirs, entry, "type", "of a field is no type like float, uvec2 or mat4");
    uint32_t size = 4 * type_components(field->type), items = 1;
    if (!take_number(theirs, entry, item, "offset", 0, MOST_STRIDE, &field->offset) ||
        !take_number(theirs, entry, item, "array_count", 0, MOST_STRIDE / 4, &field->array_count) ||
        !take_number(theirs, entry, item, "array_stride", 0, MOST_STRIDE, &field->array_stride))
        return false;
    items = field->array_count ? field->array_count : 1;
    if (field->array_count && field->array_stride < size)
        return wrong(theirs, entry, "array_stride", "is less than an item's size");
    if (field->offset + (uint64_t)(items - 1) * field->array_stride + size > entry->what.stride)
        return wrong(theirs, entry, "offset", "of a field leaves no room for it in \"stride\"");
    return true;
}

static bool take_buffer(const struct theirs *theirs, struct their_entry *entry, const cJSON *item)
{
    const cJSON *fields = cJSON_GetObjectItem(item, "fields"), *field;
    int count = cJSON_GetArraySize(fields);
    entry->what.kind = DT_BUFFER;
    if (count < 1 || count > MOST_FIELDS)
        return wrong(theirs, entry, "fields", "is not a list of 1 to 256 fields");
    if (!take_number(theirs, entry, item, "stride", 4, MOST_STRIDE, &entry->what.stride) ||
        !take_number(theirs, entry, item, "count", 1, UINT32_MAX, &entry->extent[0]))
        return false;
    entry->fields = calloc((size_t)count, sizeof *entry->fields);
    if (!entry->fields)
        return wrong(theirs, entry, "fields", "need more memory than there is");
    entry->what.fields = entry->fields;
    entry->extent[1] = entry->extent[2] = 1;
    cJSON_ArrayForEach(field, fields)
    {
        if (!take_field(theirs, entry, field, &entry->fields[entry->what.field_count++]))
            return false;
    }
    return true;
}

/* Texels that only files have, and the format that they get. */
enum { ZEROS = 16, ONES }; /* for `from` */
struct their_texel {
    const char *name;
    uint32_t bytes;
    int format;      /* enum dt_format, or one of formats.h */
    uint8_t from[4]; /* the byte of the file that each byte of the format has */
    bool stencil;    /* a part of the texel above, an entry of its own */
};
static const struct their_texel their_texels[] = {
    {"rgb8", 3, DT_FORMAT_RGBA8, {0, 1, 2, ONES}, false},
    {"rgb8_srgb", 3, DT_FORMAT_RGBA8_SRGB, {0, 1, 2, ONES}, false},
    {"bgra8", 4, DT_FORMAT_RGBA8, {2, 1, 0, 3}, false},
    {"bgra8_srgb", 4, DT_FORMAT_RGBA8_SRGB, {2, 1, 0, 3}, false},
    {"r11g11b10", 4, DT_FORMAT_R11G11B10F, {0, 1, 2, 3}, false},
    {"d24", 4, FORMAT_D24, {0, 1, 2, ZEROS}, false},
    {"d24s8", 4, FORMAT_D24, {0, 1, 2, ZEROS}, false},
    {"d24s8", 4, DT_FORMAT_R8UI, {3}, true},
    {"d32fs8", 8, DT_FORMAT_D32F, {0, 1, 2, 3}, false},
    {"d32fs8", 8, DT_FORMAT_R8UI, {4}, true},
};

static bool find_format(struct their_entry *entry, const char *name, bool stencil)
{
    for (size_t i = 0; name && i < DT_ARRAY_COUNT(their_texels); i++)
        if (!strcmp(name, their_texels[i].name) && stencil == their_texels[i].stencil) {
            entry->texel = &their_texels[i];
            entry->what.format = (enum dt_format)their_texels[i].format;
            return true;
        }
    for (int i = 0; name && i < FORMAT_ALL && !stencil; i++)
        if (!strcmp(name, format_info((enum dt_format)i)->name)) {
            entry->what.format = (enum dt_format)i;
            return true;
        }
    return false;
}

/* Whether a texel has depth and stencil: the entry is the depth, and the stencil needs one of its own. */
static bool has_stencil(const struct their_entry *entry)
{
    return entry->texel && !entry->texel->stencil &&
           find_format(&(struct their_entry){0}, entry->texel->name, true);
}

static uint32_t texel_size(const struct their_entry *entry)
{
    return entry->texel ? entry->texel->bytes : resource_stride(&entry->what);
}

static bool take_image(const struct theirs *theirs, struct their_entry *entry, const cJSON *item,
                       bool stencil)
{
    static const char *const names[] = {"width", "height", "layers"};
    const char *name = their_text(item, "format"), *origin = their_text(item, "origin");
    uint32_t samples = 1;
    if (!find_format(entry, name, stencil))
        return wrong(theirs, entry, "format", "is no format like rgba8, rgba16f or d32f");
    entry->what.kind = DT_IMAGE;
    entry->what.mips = 1;
    entry->extent[2] = 1;
    for (int i = 0; i < 3; i++)
        if (!take_number(theirs, entry, item, names[i], 1, MOST_EXTENT, &entry->extent[i]))
            return false;
    uint32_t stride = texel_size(entry);
    if (!take_number(theirs, entry, item, "samples", 1, MOST_SAMPLES, &samples) ||
        !take_number(theirs, entry, item, "stride", stride, stride, &stride))
        return false;
    entry->extent[2] *= samples;
    entry->what.layered = entry->extent[2] > 1;
    entry->read_as = samples > 1 ? "layers are samples" : NULL;
    origin = origin ? origin : their_text(theirs->manifest, "origin");
    if (origin && strcmp(origin, "top") != 0 && strcmp(origin, "bottom") != 0)
        return wrong(theirs, entry, "origin", "is neither \"top\" nor \"bottom\"");
    entry->origin = !origin ? ORIGIN_UNKNOWN : *origin == 't' ? ORIGIN_TOP : ORIGIN_BOTTOM;
    return true;
}

static bool take_entry(struct theirs *theirs, const cJSON *item, bool stencil)
{
    struct their_entry *entry = add_their_entry(theirs);
    const char *names[] = {"pass", "resource", "file"}, *kind = their_text(item, "kind");
    if (!entry)
        return false;
    char **places[] = {&entry->pass, &entry->resource, &entry->file};
    for (int i = 0; i < 3; i++) {
        const char *text = their_text(item, names[i]);
        *places[i] = !text               ? NULL
                     : stencil && i == 1 ? format_string("%s.stencil", text)
                                         : strdup(text);
        if (!*places[i])
            return wrong(theirs, entry, names[i], "is missing");
    }
    entry->what.name = entry->resource;
    entry->what.doc = their_text(item, "about");
    entry->described = true;
    if (!take_number(theirs, entry, item, "mip", 0, 31, &entry->mip) ||
        !take_number(theirs, entry, item, "frame", 0, UINT32_MAX, &entry->frame))
        return false;
    if (!kind || (strcmp(kind, "buffer") != 0 && strcmp(kind, "image") != 0))
        return wrong(theirs, entry, "kind", "is neither \"buffer\" nor \"image\"");
    return *kind == 'b' ? take_buffer(theirs, entry, item)
                        : take_image(theirs, entry, item, stencil);
}

static bool take_manifest(struct theirs *theirs)
{
    const cJSON *entries = cJSON_GetObjectItem(theirs->manifest, "entries"), *item;
    const cJSON *version = cJSON_GetObjectItem(theirs->manifest, "version");
    if (!cJSON_IsArray(entries) || cJSON_GetArraySize(entries) > MOST_ENTRIES)
        return report_error(
            theirs->log, "%s/manifest.json: is no manifest of a dump: it has no list \"entries\"",
            theirs->folder);
    if (version && cJSON_GetNumberValue(version) != 1)
        return report_error(theirs->log,
                            "%s/manifest.json: \"version\" is not 1; a newer diptych may read it",
                            theirs->folder);
    cJSON_ArrayForEach(item, entries)
    {
        if (!take_entry(theirs, item, false) ||
            (has_stencil(&theirs->entries[theirs->count - 1]) && !take_entry(theirs, item, true)))
            return false;
    }
    return true;
}

/* ---- Pictures and arrays alone ---------------------------------------------------------------- */

static const char *extension_of(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && dot != name ? dot : "";
}

static int is_ours(const struct dirent *file)
{
    const char *end = extension_of(file->d_name);
    return !strcmp(end, ".png") || !strcmp(end, ".exr") || !strcmp(end, ".npy");
}

/* Cuts ".mip3" or ".frame7" off the end. */
static bool cut_number(char *name, const char *word, uint32_t *number)
{
    char *dot = strrchr(name, '.'), *end = NULL;
    size_t length = strlen(word);
    if (!dot || strncmp(dot + 1, word, length) != 0)
        return false;
    unsigned long value = strtoul(dot + 1 + length, &end, 10);
    if (end == dot + 1 + length || *end || value > UINT32_MAX)
        return false;
    *number = (uint32_t)value;
    *dot = 0;
    return true;
}

/* "02.lighting.radiance.mip1": the number in front orders a listing. A name without a dot is that of
 * pass and resource. */
static bool take_file(struct theirs *theirs, const char *file)
{
    struct their_entry *entry = add_their_entry(theirs);
    if (!entry)
        return false;
    entry->file = strdup(file);
    char *name = text_printable(file);
    char *stem = name;
    if (name)
        name[strlen(name) - 4] = 0;
    while (name &&
           (cut_number(name, "mip", &entry->mip) || cut_number(name, "frame", &entry->frame)))
        ;
    size_t digits = name ? strspn(name, "0123456789") : 0;
    if (digits && name[digits] == '.' && name[digits + 1])
        stem = name + digits + 1;
    char *dot = stem ? strchr(stem, '.') : NULL;
    entry->pass = stem ? strndup(stem, dot ? (size_t)(dot - stem) : strlen(stem)) : NULL;
    entry->resource = stem ? strdup(dot ? dot + 1 : stem) : NULL;
    entry->what.name = entry->resource;
    free(name);
    if (!entry->file || !entry->pass || !entry->resource)
        report_error(theirs->log, "out of memory");
    return entry->file && entry->pass && entry->resource;
}

static bool list_files(struct theirs *theirs)
{
    struct dirent **files = NULL;
    int count = scandir(theirs->folder, &files, is_ours, alphasort);
    bool good = count > 0;
    if (count < 0)
        report_error(theirs->log, "%s: cannot be listed: %s", theirs->folder, strerror(errno));
    else if (!count)
        report_error(
            theirs->log,
            "%s: is no dump: it has no manifest.json, and no PASS.RESOURCE.png, .exr or .npy",
            theirs->folder);
    for (int i = 0; i < count; i++) {
        good = good && take_file(theirs, files[i]->d_name);
        free(files[i]);
    }
    free(files);
    return good;
}

/* ---- The folder ------------------------------------------------------------------------------- */

static void number_repeats(struct theirs *theirs)
{
    for (uint32_t i = 0; i < theirs->count; i++)
        for (uint32_t k = 0; k < i; k++) {
            struct their_entry *a = &theirs->entries[i], *b = &theirs->entries[k];
            a->again += !strcmp(a->pass, b->pass) && !strcmp(a->resource, b->resource) &&
                        a->mip == b->mip && a->frame == b->frame;
        }
}

static char *theirs_name(const struct theirs *theirs)
{
    const char *backend = their_text(theirs->manifest, "backend");
    if (backend && *backend)
        return strdup(backend);
    char *name = text_printable(theirs->folder);
    for (size_t n = name ? strlen(name) : 0; n > 1 && name[n - 1] == '/'; n--)
        name[n - 1] = 0;
    const char *slash = name ? strrchr(name, '/') : NULL;
    char *last = name ? strdup(slash && slash[1] ? slash + 1 : name) : NULL;
    free(name);
    return last;
}

bool theirs_open(struct theirs *theirs, const char *folder, const struct dt_log *log)
{
    *theirs = (struct theirs){.folder = folder, .log = log};
    bool described = foreign_has(folder, "manifest.json");
    theirs->manifest = described ? foreign_json(folder, "manifest.json", log) : NULL;
    if (described ? !theirs->manifest || !take_manifest(theirs) : !list_files(theirs))
        return false;
    number_repeats(theirs);
    theirs->label = theirs_name(theirs);
    return theirs->label || report_error(log, "out of memory");
}

const char *theirs_source(const struct theirs *theirs)
{
    const char *source = their_text(theirs->manifest, "source");
    return source ? source : theirs->folder;
}

void theirs_close(struct theirs *theirs)
{
    for (uint32_t i = 0; i < theirs->count; i++) {
        struct their_entry *entry = &theirs->entries[i];
        free(entry->pass);
        free(entry->resource);
        free(entry->file);
        free(entry->fields);
    }
    free(theirs->entries);
    free(theirs->label);
    cJSON_Delete(theirs->manifest);
    *theirs = (struct theirs){0};
}

/* Makes the entry's format of the file's texels. */
static bool unpack(const struct theirs *theirs, const struct their_entry *entry,
                   struct dt_bytes *bytes)
{
    static const uint8_t constants[] = {[ZEROS] = 0, [ONES] = 0xff};
    const struct their_texel *texel = entry->texel;
    uint32_t size = resource_stride(&entry->what);
    size_t count = bytes->size / texel->bytes;
    uint8_t *data = malloc(count * size);
    for (size_t i = 0; data && i < count; i++)
        for (uint32_t k = 0; k < size; k++)
            data[i * size + k] = texel->from[k] < ZEROS
                                     ? bytes->data[i * texel->bytes + texel->from[k]]
                                     : constants[texel->from[k]];
    free(bytes->data);
    bytes->data = data;
    bytes->size = count * size;
    return data || report_error(theirs->log, "out of memory");
}

bool theirs_load(const struct theirs *theirs, struct their_entry *entry, struct dt_bytes *bytes)
{
    *bytes = (struct dt_bytes){0};
    if (!entry->described)
        return !strcmp(extension_of(entry->file), ".npy") ? their_npy(theirs, entry, bytes)
                                                          : their_picture(theirs, entry, bytes);
    memcpy(bytes->extent, entry->extent, sizeof bytes->extent);
    /* each product stays below 2^64: extents have 24 bits, counts 32, strides 16 */
    uint64_t elements = entry->what.kind == DT_BUFFER
                            ? entry->extent[0]
                            : (uint64_t)entry->extent[0] * entry->extent[1];
    uint64_t size = elements * texel_size(entry);
    if (size > MOST_BYTES || size * entry->extent[2] > MOST_BYTES)
        return report_error(theirs->log, "%s/%s: would have more than 4 GiB", theirs->folder,
                            entry->file);
    bytes->size = size * entry->extent[2];
    bytes->data = foreign_read_exactly(theirs->folder, entry->file, bytes->size, theirs->log);
    return bytes->data && (!entry->texel || unpack(theirs, entry, bytes));
}
