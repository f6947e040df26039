/* A preset as a spec. See chain.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "import/chain.h"
#include "gen/check/check.h"

enum { MOST_VALUES = 1024, MOST_TEXT = 512 };

struct filled { /* of a uniform or an input, in one pass */
    uint32_t pass;
    char name[256], text[MOST_TEXT];
    bool common; /* the same in all passes that have the name */
};

struct writing {
    const struct chain *chain;
    struct text *out;
    struct filled *values;
    uint32_t value_count;
};

/* ---- Parameters ------------------------------------------------------------------------------ */

const struct slang_param *chain_param(const struct chain *chain, const char *name)
{
    for (uint32_t i = 0; i < chain->pass_count; i++)
        for (uint32_t k = 0; k < chain->passes[i].slang.param_count; k++)
            if (!strcmp(chain->passes[i].slang.params[k].name, name))
                return &chain->passes[i].slang.params[k];
    return NULL;
}

/* How many parameters before it have the name in other letters: C's names are capitals. */
static unsigned count_alike(const struct chain *chain, const char *name)
{
    unsigned count = 0;
    for (uint32_t i = 0; i < chain->pass_count; i++)
        for (uint32_t k = 0; k < chain->passes[i].slang.param_count; k++) {
            const struct slang_param *param = &chain->passes[i].slang.params[k];
            if (!strcmp(param->name, name))
                return count;
            count += !strcasecmp(param->name, name) && chain_param(chain, param->name) == param;
        }
    return count;
}

/* The name that the parameter has in the spec. */
static void param_name(const struct chain *chain, const char *name, char out[160])
{
    unsigned alike = count_alike(chain, name);
    if (alike)
        snprintf(out, 160, "%.100s_%u", name, alike + 1);
    else if (name_is_free(name) && strcmp(name, "Original") != 0)
        snprintf(out, 160, "%s", name);
    else
        import_identifier(name, out, 160);
}

static bool is_read(const struct chain *chain, const char *name)
{
    for (uint32_t i = 0; i < chain->pass_count; i++)
        for (int s = 0; s < 2; s++) {
            const struct reflection *stage = &chain->passes[i].stages[s];
            for (uint32_t k = 0; k < stage->count; k++)
                if (stage->list[k].kind == REFLECTED_VALUE && !strcmp(stage->list[k].name, name))
                    return true;
        }
    return false;
}

static bool write_param(const struct writing *writing, const struct slang_param *param)
{
    const struct preset_entry *entry = preset_find(&writing->chain->preset, "%s", param->name);
    double value = param->value;
    if (entry && !slang_number(entry->value, &value))
        return report_error(&writing->chain->import->console->log,
                            "%s:%u: %s = %s: a parameter is a finite number", entry->file,
                            entry->line, entry->key, entry->value);
    double least = value < param->min ? value : param->min;
    double most = value > param->max ? value : param->max;
    char name[160];
    param_name(writing->chain, param->name, name);
    text_add(writing->out, "  %s: {value: ", name);
    text_add_float(writing->out, value);
    text_add(writing->out, ", type: float");
    if (least < most) {
        text_add(writing->out, ", min: ");
        text_add_float(writing->out, least);
        text_add(writing->out, ", max: ");
        text_add_float(writing->out, most);
    }
    if (param->step > 0) {
        text_add(writing->out, ", step: ");
        text_add_float(writing->out, param->step);
    }
    text_add(writing->out, *param->doc ? ", live: true, doc: " : ", live: true");
    if (*param->doc)
        text_add_json(writing->out, param->doc);
    text_add(writing->out, "}\n");
    return true;
}

/* Those that a shader reads, each once. */
static bool write_params(const struct writing *writing)
{
    const struct chain *chain = writing->chain;
    bool any = false, good = true;
    for (uint32_t i = 0; i < chain->pass_count; i++)
        for (uint32_t k = 0; good && k < chain->passes[i].slang.param_count; k++) {
            const struct slang_param *param = &chain->passes[i].slang.params[k];
            if (chain_param(chain, param->name) != param || !is_read(chain, param->name))
                continue;
            text_add(writing->out, any ? "" : "params:\n");
            any = true;
            good = write_param(writing, param);
        }
    return good;
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* What RetroArch puts into uniforms, besides sizes; of the type that stands in front. */
static const char *const uniforms[][2] = {
    {"MVP", "2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, -1.0, 0.0, 1.0"},
    {"FrameDirection", "1"},
    {"Rotation", "0"},
    {"OriginalFPS", "60.0"},
    {"FrameTimeDelta", "16667"},
    {"TotalSubFrames", "1"},
    {"CurrentSubFrame", "1"},
    {"OriginalAspect", "float(Original_width) / float(Original_height)"},
    {"OriginalAspectRotated", "float(Original_width) / float(Original_height)"},
    {"CoreAspect", "float(Original_width) / float(Original_height)"},
    {"CoreAspectRot", "float(Original_width) / float(Original_height)"},
    {"Gyroscope", "0.0"},
    {"Accelerometer", "0.0"},
    {"AccelerometerRest", "0.0"},
    {"EnableHDR", "0"},
    {"HDRMode", "0"},
    {"BrightnessNits", "200.0"},
    {"PaperWhiteNits", "200.0"},
    {"MaxNits", "1000.0"},
};

/* Two triangles, 0 to 1, of six vertices. */
static const char *const inputs[] = {
    "0x32 >> gl_VertexIndex & 1, 0x2c >> gl_VertexIndex & 1, 0.0, 1.0",
    "0x32 >> gl_VertexIndex & 1, 0x2c >> gl_VertexIndex & 1"};

/* The constructor's arguments; false: the spec gives the value by itself, or nothing does. */
static bool find_value(const struct chain *chain, uint32_t pass, const struct reflected *item,
                       char out[MOST_TEXT])
{
    char size[2][160], param[160];
    if (item->kind == REFLECTED_INPUT) {
        bool vec2 = !strcmp(item->type, "vec2");
        snprintf(out, MOST_TEXT, "%s", inputs[item->location || vec2]);
        return item->location < 2;
    }
    if (chain_param(chain, item->name)) {
        param_name(chain, item->name, param);
        snprintf(out, MOST_TEXT, "%s", param);
        return strcmp(param, item->name) != 0 || strcmp(item->type, "float") != 0;
    }
    for (size_t i = 0; i < DT_ARRAY_COUNT(uniforms); i++)
        if (!strcmp(uniforms[i][0], item->name)) {
            snprintf(out, MOST_TEXT, "%s", uniforms[i][1]);
            return true;
        }
    if (!strcmp(item->name, "FrameCount")) {
        unsigned period = chain->passes[pass].period;
        snprintf(out, MOST_TEXT, period ? "frame.index %% %uu" : "frame.index", period);
        return true;
    }
    if (strcmp(item->type, "vec4") != 0 || !chain_size(chain, pass, item->name, size))
        return false;
    snprintf(out, MOST_TEXT, "%.100s, %.100s, 1.0 / %.100s, 1.0 / %.100s", size[0], size[1],
             size[0], size[1]);
    return true;
}

static bool add_value(struct writing *writing, uint32_t pass, const struct reflected *item)
{
    struct filled *value = &writing->values[writing->value_count];
    char arguments[MOST_TEXT];
    for (uint32_t i = 0; i < writing->value_count; i++)
        if (writing->values[i].pass == pass && !strcmp(writing->values[i].name, item->name))
            return true;
    if (!find_value(writing->chain, pass, item, arguments))
        return true;
    if (writing->value_count == MOST_VALUES)
        return false;
    *value = (struct filled){.pass = pass, .common = true};
    snprintf(value->name, sizeof value->name, "%s", item->name);
    snprintf(value->text, sizeof value->text, "%s(%.440s)", item->type, arguments);
    writing->value_count++;
    return true;
}

static bool find_values(struct writing *writing)
{
    const struct chain *chain = writing->chain;
    for (uint32_t i = 0; i < chain->pass_count; i++)
        for (int s = 0; s < 2; s++)
            for (uint32_t k = 0; k < chain->passes[i].stages[s].count; k++) {
                const struct reflected *item = &chain->passes[i].stages[s].list[k];
                bool filled =
                    item->kind == REFLECTED_VALUE || (item->kind == REFLECTED_INPUT && s == 0);
                if (filled && *item->type && !add_value(writing, i, item))
                    return false;
            }
    for (uint32_t i = 0; i < writing->value_count; i++)
        for (uint32_t k = 0; k < writing->value_count; k++)
            if (!strcmp(writing->values[i].name, writing->values[k].name) &&
                strcmp(writing->values[i].text, writing->values[k].text) != 0)
                writing->values[i].common = false;
    return true;
}

static void write_common(const struct writing *writing)
{
    bool any = false;
    for (uint32_t i = 0; i < writing->value_count; i++) {
        const struct filled *value = &writing->values[i];
        bool first = value->common;
        for (uint32_t k = 0; k < i; k++)
            first &= strcmp(writing->values[k].name, value->name) != 0;
        if (!first)
            continue;
        text_add(writing->out, "%s  %s: ", any ? "" : "values:\n", value->name);
        any = true;
        text_add_json(writing->out, value->text);
        text_add(writing->out, "\n");
    }
}

/* ---- Images and samplers --------------------------------------------------------------------- */

/* Width and height of a picture, for the values that name them. */
static void add_sides(const struct writing *writing, const char *image, struct text *out)
{
    for (int axis = 0; axis < 2; axis++) {
        const char *side = axis ? "height" : "width";
        char name[300];
        bool used = false;
        snprintf(name, sizeof name, "%s_%s", image, side);
        for (uint32_t i = 0; i < writing->value_count; i++)
            used |= strstr(writing->values[i].text, name) != NULL;
        if (used)
            text_add(out, "  %s: %s.%s\n", name, image, side);
    }
}

static void write_constants(const struct writing *writing)
{
    const struct chain *chain = writing->chain;
    struct text constants = {0};
    add_sides(writing, "Original", &constants);
    for (uint32_t i = 0; i < chain->picture_count; i++) {
        char image[160];
        snprintf(image, sizeof image, "lut_%s", chain->pictures[i].name);
        add_sides(writing, image, &constants);
    }
    for (uint32_t i = 0; i < chain->pass_count; i++)
        if (*chain->passes[i].width)
            text_add(&constants, "  pass%u_width: %s\n  pass%u_height: %s\n", i,
                     chain->passes[i].width, i, chain->passes[i].height);
    if (constants.length)
        text_add(writing->out, "constants:\n%s", constants.data);
    writing->out->failed |= constants.failed;
    text_free(&constants);
}

static void write_images(const struct writing *writing, const char *picture)
{
    const struct chain *chain = writing->chain;
    text_add(writing->out,
             "images:\n  Original: {file: %s, format: rgba8, doc: \"what the preset "
             "is applied to\"}\n",
             picture);
    for (uint32_t i = 0; i < chain->picture_count; i++) {
        const struct chain_picture *of = &chain->pictures[i];
        text_add(writing->out, "  lut_%s: {file: ", of->name);
        text_add_json(writing->out, of->file);
        text_add(writing->out, ", format: rgba8");
        if (of->mips > 1)
            text_add(writing->out, ", mips: %u", of->mips);
        text_add(writing->out, "}\n");
    }
    for (uint32_t i = 0; i < chain->pass_count; i++) {
        const struct chain_pass *pass = &chain->passes[i];
        text_add(writing->out, "  pass%u: {format: %s, size: ", i, pass->format);
        if (*pass->width)
            text_add(writing->out, "[pass%u_width, pass%u_height]", i, i);
        else
            text_add(writing->out, "frame");
        if (pass->mips > 1)
            text_add(writing->out, ", mips: %u, filter_mips: true", pass->mips);
        if (*pass->alias) {
            text_add(writing->out, ", doc: ");
            text_add_json(writing->out, pass->alias);
        }
        text_add(writing->out, "}\n");
    }
    if (chain->stretched)
        text_add(writing->out, "  picture: {format: rgba8, size: frame}\n");
}

static bool has_integers(const struct chain *chain, const char *image)
{
    for (uint32_t i = 0; i < chain->pass_count; i++) {
        char name[32];
        const char *format = chain->passes[i].format;
        snprintf(name, sizeof name, "pass%u", i);
        if (!strcmp(name, image))
            return format[strlen(format) - 1] == 'i';
    }
    return false;
}

static void sampler_name(const struct chain *chain, const struct chain_read *read, char out[64])
{
    bool linear = read->linear && !has_integers(chain, read->image);
    snprintf(out, 64, "%s_%s%s", linear ? "linear" : "nearest",
             has_integers(chain, read->image) ? "clamp" : read->wrap,
             read->mips && linear ? "_mips" : "");
}

/* Each sampler that a pass names, once. */
static void write_samplers(const struct writing *writing)
{
    const struct chain *chain = writing->chain;
    char seen[16][64] = {"linear_clamp"};
    unsigned count = chain->stretched;
    if (count)
        text_add(writing->out, "samplers:\n  linear_clamp: {kind: filter, filter: linear}\n");
    for (uint32_t i = 0; i < chain->pass_count; i++)
        for (uint32_t k = 0; k < chain->passes[i].stages[1].count; k++) {
            const struct reflected *item = &chain->passes[i].stages[1].list[k];
            struct chain_read read;
            char name[64];
            unsigned s = 0;
            if (item->kind != REFLECTED_TEXTURE || !chain_find(chain, i, item->name, &read))
                continue;
            sampler_name(chain, &read, name);
            while (s < count && strcmp(seen[s], name) != 0)
                s++;
            if (s < count || count == DT_ARRAY_COUNT(seen))
                continue;
            memcpy(seen[count++], name, sizeof name);
            text_add(writing->out, count > 1 ? "" : "samplers:\n");
            text_add(writing->out, "  %s: {kind: filter, filter: %s, wrap: %s%s}\n", name,
                     *name == 'l' ? "linear" : "nearest",
                     strstr(name, "_clamp") ? "clamp" : read.wrap,
                     strstr(name, "_mips") ? ", mip_filter: linear" : "");
        }
}

/* ---- Passes ---------------------------------------------------------------------------------- */

static bool refuse_texture(const struct chain *chain, const struct chain_pass *pass,
                           const char *name, const char *why)
{
    size_t size;
    const struct dt_log silent = {0};
    char *text = import_text(pass->path, &size, &silent);
    import_refuse(chain->import, pass->path, text, name, "the texture `%s` %s", name, why);
    free(text);
    return false;
}

static bool write_reads(const struct writing *writing, uint32_t index)
{
    const struct chain *chain = writing->chain;
    const struct chain_pass *pass = &chain->passes[index];
    bool any = false, before = false;
    for (uint32_t k = 0; k < pass->stages[1].count; k++) {
        const struct reflected *item = &pass->stages[1].list[k];
        struct chain_read read;
        char sampler[64];
        if (item->kind != REFLECTED_TEXTURE)
            continue;
        if (!chain_find(chain, index, item->name, &read))
            return refuse_texture(chain, pass, item->name,
                                  "is neither a pass nor a picture of the preset");
        if (read.previous > MOST_HISTORY)
            return refuse_texture(chain, pass, item->name, "is more than 64 frames old");
        sampler_name(chain, &read, sampler);
        text_add(writing->out, "%s{name: %s, as: %s, sampler: %s",
                 any ? ",\n            " : "    reads: [", read.image, item->name, sampler);
        if (read.previous)
            text_add(writing->out, ", previous: %u", read.previous);
        before |= read.previous > 0;
        text_add(writing->out, "}");
        any = true;
    }
    text_add(writing->out, any ? "]\n" : "");
    if (before)
        text_add(writing->out,
                 "    allow: {content: \"RetroArch clears earlier frames before the first\"}\n");
    return true;
}

static void write_own_values(const struct writing *writing, uint32_t pass)
{
    bool any = false;
    for (uint32_t i = 0; i < writing->value_count; i++) {
        const struct filled *value = &writing->values[i];
        if (value->common || value->pass != pass)
            continue;
        text_add(writing->out, "%s      %s: ", any ? "" : "    values:\n", value->name);
        any = true;
        text_add_json(writing->out, value->text);
        text_add(writing->out, "\n");
    }
}

static bool write_passes(const struct writing *writing)
{
    const struct chain *chain = writing->chain;
    text_add(writing->out, "passes:\n");
    for (uint32_t i = 0; i < chain->pass_count; i++) {
        text_add(writing->out, "  - name: draw%u\n    draw: {vertices: 6}\n", i);
        if (!write_reads(writing, i))
            return false;
        text_add(writing->out, "    writes: [pass%u]\n    shader: ", i);
        text_add_json(writing->out, chain->passes[i].file);
        text_add(writing->out, "\n");
        write_own_values(writing, i);
    }
    if (chain->stretched)
        text_add(writing->out,
                 "  - name: stretch\n    draw: fullscreen\n    reads: [{name: pass%u, as: from, "
                 "sampler: linear_clamp}]\n    writes: [picture]\n    shader: copy/stretch.glsl\n",
                 chain->pass_count - 1);
    text_add(writing->out, "output: {display: %s", chain->stretched ? "picture" : "");
    if (!chain->stretched)
        text_add(writing->out, "pass%u", chain->pass_count - 1);
    text_add(writing->out, "}\n");
    return true;
}

bool chain_write(const struct chain *chain, const char *picture, struct text *out)
{
    struct writing writing = {chain, out, calloc(MOST_VALUES, sizeof *writing.values), 0};
    bool good = writing.values && find_values(&writing);
    if (!good)
        report_error(&chain->import->console->log, "there are more than %d values", MOST_VALUES);
    text_add(out,
             "# By `diptych import`. --input Original=FILE.png, of the same size, is another "
             "picture.\npipeline: %s\norigin: top\n",
             chain->import->name);
    good = good && write_params(&writing);
    if (good) {
        write_constants(&writing);
        write_images(&writing, picture);
        write_samplers(&writing);
        write_common(&writing);
        good = write_passes(&writing);
    }
    free(writing.values);
    return good;
}
