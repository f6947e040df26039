/* See chain.h. The meaning of a preset's keys follows RetroArch's Vulkan driver. */
#include "import/chain.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "scenes/child.h"
#include "scenes/picture_size.h"
#include "gen/check/check.h"

enum { MOST_SIDE = 16384, MOST_SCALE = 1000 };

/* ---- Keys of a preset ------------------------------------------------------------------------ */

static bool is_true(const struct preset_entry *entry)
{
    return entry && (!strcasecmp(entry->value, "true") || !strcmp(entry->value, "1"));
}

static const char *wrap_of(const struct preset_entry *entry)
{
    static const char *const words[][2] = {
        {"clamp_to_edge", "clamp"}, {"repeat", "repeat"}, {"mirrored_repeat", "mirror"}};
    for (size_t i = 0; entry && i < DT_ARRAY_COUNT(words); i++)
        if (!strcmp(entry->value, words[i][0]))
            return words[i][1];
    return "border";
}

static const struct dt_log *chain_log(const struct chain *chain)
{
    return &chain->import->console->log;
}

static bool refuse_line(const struct chain *chain, const struct preset_entry *entry,
                        const char *why)
{
    if (entry)
        report_error(chain_log(chain), "%s:%u: %s = %s: %s", entry->file, entry->line, entry->key,
                     entry->value, why);
    else
        report_error(chain_log(chain), "%s", why);
    return false;
}

/* A key with an axis, `scale_x3`, before the one of both, `scale3`. */
static const struct preset_entry *find_axis(const struct chain *chain, const char *key, int axis,
                                            uint32_t pass)
{
    const struct preset_entry *own =
        preset_find(&chain->preset, "%s_%c%u", key, axis ? 'y' : 'x', pass);
    return own ? own : preset_find(&chain->preset, "%s%u", key, pass);
}

/* "name of the pass's size" as a constant of the spec. */
static void name_size(const struct chain *chain, uint32_t pass, int axis, char out[160])
{
    const struct chain_pass *of = &chain->passes[pass];
    if (*of->width)
        snprintf(out, 160, "pass%u_%s", pass, axis ? "height" : "width");
    else
        snprintf(out, 160, "frame.%s", axis ? "height" : "width");
}

/* base * scale, rounded, as an integer expression: scale is a decimal fraction. *size: the base's value, then the result's. */
static bool scale_by(const char *base, const char *scale, char out[160], uint32_t *size)
{
    uint64_t above = 0, below = 1;
    bool point = false;
    const char *at = scale;
    for (; isdigit((unsigned char)*at) || (*at == '.' && !point); at++) {
        point |= *at == '.';
        if (*at == '.' || below > 1000 || above > UINT32_MAX)
            continue;
        above = 10 * above + (uint64_t)(*at - '0');
        below *= point ? 10 : 1;
    }
    while (below > 1 && above % 10 == 0) {
        above /= 10;
        below /= 10;
    }
    if (below == 1)
        snprintf(out, 160, above == 1 ? "%.60s" : "%.60s * %u", base, (unsigned)above);
    else
        snprintf(out, 160, "max(1, (%.60s * %u + %u) / %u)", base, (unsigned)above,
                 (unsigned)below / 2, (unsigned)below);
    uint64_t value = (*size * above + below / 2) / below;
    *size = !*size ? 0 : value > MOST_SIDE ? MOST_SIDE : value ? (uint32_t)value : 1;
    return above && above <= MOST_SCALE * below && (!*at || *at == 'f');
}

static bool read_size(struct chain *chain, uint32_t pass, int axis, char out[160])
{
    const struct preset_entry *type = find_axis(chain, "scale_type", axis, pass);
    const struct preset_entry *scale = find_axis(chain, "scale", axis, pass);
    const char *factor = scale ? scale->value : "1.0";
    uint32_t *size = &chain->passes[pass].size[axis];
    char base[160];
    if (type && !strcmp(type->value, "absolute")) {
        double side = 0;
        bool good = scale && slang_number(scale->value, &side) && side >= 1 && side <= MOST_SIDE;
        snprintf(out, 160, "%.0f", side);
        *size = good ? (uint32_t)side : 0;
        return good || refuse_line(chain, scale ? scale : type,
                                   "an absolute size needs a number of texels, 1 to 16384");
    }
    if (type && !strcmp(type->value, "viewport"))
        snprintf(base, sizeof base, "frame.%s", axis ? "height" : "width");
    else if (type && strcmp(type->value, "source") != 0)
        return refuse_line(chain, type, "a scale is of source, viewport or absolute");
    else if (pass)
        name_size(chain, pass - 1, axis, base);
    else
        snprintf(base, sizeof base, "Original.%s", axis ? "height" : "width");
    if (!type || strcmp(type->value, "viewport") != 0)
        *size = pass ? chain->passes[pass - 1].size[axis] : chain->size[axis];
    return scale_by(base, factor, out, size) ||
           refuse_line(chain, scale ? scale : type, "a scale is a number above 0, at most 1000");
}

/* ---- Passes ---------------------------------------------------------------------------------- */

static bool is_last(const struct chain *chain, uint32_t pass)
{
    return pass + 1 == chain->pass_count;
}

static bool has_scale(const struct chain *chain, uint32_t pass)
{
    return find_axis(chain, "scale_type", 0, pass) || find_axis(chain, "scale_type", 1, pass);
}

/* Sets the size; "" is the frame's. */
static bool place_pass(struct chain *chain, uint32_t index)
{
    struct chain_pass *pass = &chain->passes[index];
    char size[2][160] = {"frame.width", "frame.height"};
    if (!is_last(chain, index) || has_scale(chain, index))
        for (int axis = 0; axis < 2; axis++)
            if (!read_size(chain, index, axis, size[axis]))
                return false;
    if (strcmp(size[0], "frame.width") != 0 || strcmp(size[1], "frame.height") != 0) {
        snprintf(pass->width, sizeof pass->width, "%s", size[0]);
        snprintf(pass->height, sizeof pass->height, "%s", size[1]);
    }
    return true;
}

static void choose_format(struct chain *chain, uint32_t index)
{
    struct chain_pass *pass = &chain->passes[index];
    pass->format = pass->slang.format ? pass->slang.format : "rgba8";
    if (is_true(preset_find(&chain->preset, "srgb_framebuffer%u", index)))
        pass->format = "rgba8_srgb";
    else if (is_true(preset_find(&chain->preset, "float_framebuffer%u", index)))
        pass->format = "rgba16f";
}

static bool reflect_stages(struct chain *chain, const char *path, struct chain_pass *pass)
{
    for (int stage = REFLECT_VERTEX; stage <= REFLECT_FRAGMENT; stage++) {
        char *why = NULL;
        bool good = reflect(pass->slang.text.data, stage, NULL, NULL,
                            &pass->stages[stage - REFLECT_VERTEX], &why);
        if (!good)
            report_error(chain_log(chain), "%s: it does not compile: %s", path,
                         why ? why : "out of memory");
        free(why);
        if (!good)
            return false;
    }
    return true;
}

/* The text in the folder, once for all passes with the same. */
static bool write_text(struct chain *chain, const char *path, uint32_t index)
{
    struct chain_pass *pass = &chain->passes[index];
    const struct text *text = &pass->slang.text;
    for (uint32_t i = 0; i < index; i++)
        if (chain->passes[i].slang.text.length == text->length &&
            !memcmp(chain->passes[i].slang.text.data, text->data, text->length)) {
            memcpy(pass->file, chain->passes[i].file, sizeof pass->file);
            return true;
        }
    char name[128];
    import_file_name(path, name, sizeof name);
    snprintf(pass->file, sizeof pass->file, "%02u-%.*s.glsl", index, (int)strcspn(name, "."), name);
    return folder_write(&chain->import->folder, pass->file, text->data, text->length);
}

static bool read_pass(struct chain *chain, uint32_t index)
{
    struct chain_pass *pass = &chain->passes[index];
    const struct preset *preset = &chain->preset;
    const struct preset_entry *shader = preset_find(preset, "shader%u", index);
    const struct preset_entry *alias = preset_find(preset, "alias%u", index);
    const struct preset_entry *period = preset_find(preset, "frame_count_mod%u", index);
    if (!shader)
        return report_error(chain_log(chain), "%s:%u: there is no shader%u",
                            preset_find(preset, "shaders")->file,
                            preset_find(preset, "shaders")->line, index);
    char *path = pass->path = slang_path(shader->file, shader->value);
    bool good = path && slang_read(path, &pass->slang, chain_log(chain));
    if (!good)
        refuse_line(chain, shader, "this shader cannot be used");
    snprintf(pass->alias, sizeof pass->alias, "%s",
             alias && *alias->value ? alias->value : pass->slang.name);
    pass->linear = is_true(preset_find(preset, "filter_linear%u", index));
    pass->mipmap = is_true(preset_find(preset, "mipmap_input%u", index));
    pass->wrap = wrap_of(preset_find(preset, "wrap_mode%u", index));
    double modulus = 0;
    if (period && (!slang_number(period->value, &modulus) || modulus < 0 || modulus > INT32_MAX))
        return refuse_line(chain, period, "this is no number of frames");
    pass->period = (unsigned)modulus;
    choose_format(chain, index);
    if (good)
        child_opens(path);
    good = good && place_pass(chain, index) && reflect_stages(chain, path, pass) &&
           write_text(chain, path, index);
    return good;
}

static uint32_t full_mips(uint32_t width, uint32_t height)
{
    uint32_t mips = 1;
    for (uint32_t side = width > height ? width : height; side > 1; side /= 2)
        mips++;
    return mips;
}

/* All mips, as RetroArch; a size by the frame's has as many at every size, so the smallest is given. */
static void add_mips(struct chain_pass *pass)
{
    char size[2][160];
    bool frame = !*pass->width;
    pass->mips = full_mips(pass->size[0], pass->size[1]);
    if (pass->size[0] && pass->size[1])
        return;
    pass->mips = CHAIN_MIPS;
    snprintf(size[0], 160, "max(%d, %.140s)", 1 << (CHAIN_MIPS - 1),
             frame ? "frame.width" : pass->width);
    snprintf(size[1], 160, "max(%d, %.140s)", 1 << (CHAIN_MIPS - 1),
             frame ? "frame.height" : pass->height);
    memcpy(pass->width, size[0], sizeof size[0]);
    memcpy(pass->height, size[1], sizeof size[1]);
}

static bool read_passes(struct chain *chain)
{
    const struct preset_entry *shaders = preset_find(&chain->preset, "shaders");
    long count = shaders ? strtol(shaders->value, NULL, 10) : 0;
    if (!shaders)
        return report_error(chain_log(chain), "%s: this preset has no `shaders`",
                            chain->import->files[0]);
    if (count < 1 || count > MOST_PASSES)
        return refuse_line(chain, shaders, "a preset has 1 to 128 passes");
    chain->pass_count = (uint32_t)count;
    for (uint32_t i = 0; i < chain->pass_count; i++)
        if (!read_pass(chain, i))
            return false;
    for (uint32_t i = 1; i < chain->pass_count; i++)
        if (chain->passes[i].mipmap)
            add_mips(&chain->passes[i - 1]);
    const struct chain_pass *last = &chain->passes[count - 1];
    chain->stretched = *last->width || strcmp(last->format, "rgba8") != 0;
    return true;
}

/* ---- Look-up pictures ------------------------------------------------------------------------ */

static bool read_picture(struct chain *chain, const char *name, const struct preset_entry *list)
{
    struct chain_picture *picture = &chain->pictures[chain->picture_count];
    const struct preset *preset = &chain->preset;
    const struct preset_entry *entry = preset_find(preset, "%s", name);
    char image[256];
    snprintf(image, sizeof image, "lut_%s", name);
    size_t word = 0;
    while (text_is_word(name[word]))
        word++;
    if (name[word] || !name_is_free(image))
        return refuse_line(chain, list, "a name of a picture is letters, digits and _");
    for (uint32_t i = 0; i < chain->picture_count; i++)
        if (!strcmp(chain->pictures[i].name, name))
            return refuse_line(chain, list, "a picture stands twice");
    const char *why = "it is named in no line of the preset";
    uint32_t size[2];
    char *path = entry ? slang_path(entry->file, entry->value) : NULL;
    bool good = path && picture_size(path, &size[0], &size[1], &why);
    if (!entry)
        return refuse_line(chain, list, why);
    if (!good) {
        free(path);
        return refuse_line(chain, entry, why);
    }
    snprintf(picture->name, sizeof picture->name, "%s", name);
    const char *dot = strrchr(path, '.');
    snprintf(picture->file, sizeof picture->file, "%.120s%.16s", image,
             dot && folder_takes(dot + 1) ? dot : "");
    picture->linear = is_true(preset_find(preset, "%s_linear", name));
    picture->wrap = wrap_of(preset_find(preset, "%s_wrap_mode", name));
    bool mipmap = is_true(preset_find(preset, "%s_mipmap", name));
    picture->mips = mipmap ? full_mips(size[0], size[1]) : 1;
    chain->picture_count++;
    good = import_copy(chain->import, path, picture->file);
    free(path);
    return good;
}

static bool read_pictures(struct chain *chain)
{
    const struct preset_entry *list = preset_find(&chain->preset, "textures");
    char *names = list ? strdup(list->value) : NULL, *rest = names, *name;
    bool good = true;
    while (good && rest && (name = strsep(&rest, ";"))) {
        name += strspn(name, " \t");
        name[strcspn(name, " \t")] = 0;
        if (*name && chain->picture_count == MOST_PICTURES)
            good = refuse_line(chain, list, "there are more than 64 pictures");
        else if (*name)
            good = read_picture(chain, name, list);
    }
    free(names);
    return good;
}

/* ---- Names ----------------------------------------------------------------------------------- */

/* The number behind the prefix; -1: another name. */
static int numbered(const char *name, const char *prefix)
{
    size_t length = strlen(prefix);
    if (strncmp(name, prefix, length) != 0 || !name[length] ||
        name[length + strspn(name + length, "0123456789")])
        return -1;
    unsigned long number = strtoul(name + length, NULL, 10);
    return number < INT32_MAX ? (int)number : INT32_MAX;
}

/* The pass with the alias, of which the name may go on with `ending`; -1: none. */
static int aliased(const struct chain *chain, const char *name, const char *ending)
{
    for (uint32_t i = 0; i < chain->pass_count; i++) {
        const char *alias = chain->passes[i].alias;
        size_t length = strlen(alias);
        if (length && !strncmp(name, alias, length) && !strcmp(name + length, ending))
            return (int)i;
    }
    return -1;
}

/* A pass's output is filtered as the pass behind it reads it. */
static bool find_output(const struct chain *chain, int pass, unsigned previous,
                        struct chain_read *read)
{
    if (pass < 0 || (uint32_t)pass >= chain->pass_count)
        return false;
    const struct chain_pass *reader =
        &chain->passes[previous || (uint32_t)pass + 1 == chain->pass_count ? pass : pass + 1];
    *read = (struct chain_read){.previous = previous,
                                .linear = reader->linear,
                                .wrap = reader->wrap,
                                .mips = chain->passes[pass].mips > 1 && !previous};
    snprintf(read->image, sizeof read->image, "pass%d", pass);
    return true;
}

static bool find_picture(const struct chain *chain, const char *name, struct chain_read *read)
{
    for (uint32_t i = 0; i < chain->picture_count; i++) {
        const struct chain_picture *picture = &chain->pictures[i];
        if (strcmp(picture->name, name) != 0 && numbered(name, "User") != (int)i)
            continue;
        *read = (struct chain_read){
            .linear = picture->linear, .wrap = picture->wrap, .mips = picture->mips > 1};
        snprintf(read->image, sizeof read->image, "lut_%s", picture->name);
        return true;
    }
    return false;
}

bool chain_find(const struct chain *chain, uint32_t pass, const char *name, struct chain_read *read)
{
    bool source = !strcmp(name, "Source");
    int history =
        !strcmp(name, "Original") || (source && !pass) ? 0 : numbered(name, "OriginalHistory");
    if (history >= 0) {
        *read = (struct chain_read){.image = "Original",
                                    .previous = (unsigned)history,
                                    .linear = chain->passes[0].linear,
                                    .wrap = chain->passes[0].wrap};
        return true;
    }
    int feedback = numbered(name, "PassFeedback");
    feedback = feedback >= 0 ? feedback : aliased(chain, name, "Feedback");
    if (feedback >= 0 && aliased(chain, name, "") < 0)
        return find_output(chain, feedback, 1, read);
    int output = source ? (int)pass - 1 : numbered(name, "PassOutput");
    output = output >= 0 ? output : aliased(chain, name, "");
    if (output >= (int)pass)
        return find_output(chain, output, 1, read); /* not yet drawn in this frame */
    return find_output(chain, output, 0, read) || find_picture(chain, name, read);
}

static bool size_of_image(const struct chain *chain, const char *image, char out[2][160])
{
    int pass = numbered(image, "pass");
    for (int axis = 0; axis < 2; axis++)
        if (pass >= 0)
            name_size(chain, (uint32_t)pass, axis, out[axis]);
        else
            snprintf(out[axis], 160, "%.140s_%s", image, axis ? "height" : "width");
    return true;
}

/* SourceSize, OriginalHistorySize2, PassOutputSize3, ALIASSize, ALIASFeedbackSize: the name without
 * Size, if it has a meaning. */
bool chain_size(const struct chain *chain, uint32_t pass, const char *name, char out[2][160])
{
    struct chain_read read;
    char texture[256];
    const char *size = NULL;
    for (const char *at = name; (at = strstr(at, "Size")); at++)
        size = at;
    if (!size)
        return false;
    snprintf(texture, sizeof texture, "%.*s%s", (int)(size - name), name, size + 4);
    if (!strcmp(texture, "Output"))
        snprintf(texture, sizeof texture, "pass%u", pass);
    else if (!strcmp(texture, "FinalViewport")) {
        snprintf(out[0], 160, "frame.width");
        snprintf(out[1], 160, "frame.height");
        return true;
    } else if (!chain_find(chain, pass, texture, &read))
        return false;
    else
        snprintf(texture, sizeof texture, "%s", read.image);
    return size_of_image(chain, texture, out);
}

/* ---- Keys that have no meaning ----------------------------------------------------------------- */

static bool is_key(const struct chain *chain, const char *key, const char *const *names,
                   size_t count)
{
    static const char *const alone[] = {"shaders", "textures", "parameters", "feedback_pass"};
    static const char *const endings[] = {"", "_linear", "_wrap_mode", "_mipmap"};
    for (size_t i = 0; i < count; i++)
        if (numbered(key, names[i]) >= 0)
            return true;
    for (size_t i = 0; i < DT_ARRAY_COUNT(alone); i++)
        if (!strcmp(key, alone[i]))
            return true;
    for (uint32_t i = 0; i < chain->picture_count; i++) {
        const char *name = chain->pictures[i].name;
        for (size_t k = 0; k < DT_ARRAY_COUNT(endings); k++)
            if (!strncmp(key, name, strlen(name)) && !strcmp(key + strlen(name), endings[k]))
                return true;
    }
    return chain_param(chain, key);
}

static void warn_of_keys(const struct chain *chain)
{
    static const char *const names[] = {
        "shader",  "alias",      "filter_linear",    "mipmap_input",     "wrap_mode",
        "scale_x", "scale_y",    "scale_type_x",     "scale_type_y",     "frame_count_mod",
        "scale",   "scale_type", "srgb_framebuffer", "float_framebuffer"};
    enum { MOST_WARNINGS = 8 };
    unsigned count = 0;
    for (uint32_t i = 0; i < chain->preset.count; i++) {
        const struct preset_entry *entry = &chain->preset.entries[i];
        if (is_key(chain, entry->key, names, DT_ARRAY_COUNT(names)) || ++count > MOST_WARNINGS)
            continue;
        char plain[64]; /* scale_type_0 is scale_type0 */
        size_t length = strcspn(entry->key, "0123456789");
        snprintf(plain, sizeof plain, "%.*s%s", length ? (int)length - 1 : 0, entry->key,
                 entry->key + length);
        bool near = is_key(chain, plain, names, DT_ARRAY_COUNT(names));
        report_message(chain_log(chain), DT_WARNING,
                       "%s:%u: `%s` is no key of a preset and no parameter of its shaders%s%s%s",
                       entry->file, entry->line, entry->key, near ? "; did you mean `" : "",
                       near ? plain : "", near ? "`?" : "");
    }
    if (count > MOST_WARNINGS)
        report_message(chain_log(chain), DT_WARNING, "%u more such keys", count - MOST_WARNINGS);
}

/* ---------------------------------------------------------------------------------------------- */

bool import_preset(struct import *import, const char *path)
{
    struct chain *chain = calloc(1, sizeof *chain);
    struct text spec = {0};
    char name[256];
    if (!chain)
        return false;
    chain->import = import;
    const char *picture = NULL;
    bool good = import_picture_size(import, chain->size) &&
                preset_read(path, &chain->preset, &import->console->log) && read_passes(chain) &&
                read_pictures(chain) && (picture = import_picture(import)) &&
                chain_write(chain, picture, &spec);
    if (good)
        warn_of_keys(chain);
    snprintf(name, sizeof name, "%s.yaml", import->name);
    good = good && !spec.failed && folder_write(&import->folder, name, spec.data, spec.length);
    text_free(&spec);
    for (uint32_t i = 0; i < MOST_PASSES; i++) {
        slang_free(&chain->passes[i].slang);
        free(chain->passes[i].path);
        reflect_free(&chain->passes[i].stages[0]);
        reflect_free(&chain->passes[i].stages[1]);
    }
    preset_free(&chain->preset);
    free(chain);
    return good;
}
