/* Shaders of slang.h. RetroArch looks at #include and #pragma before the preprocessor does: in every
 * branch of #if. */
#include "import/slang.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/log.h"

enum { MOST_DEPTH = 32 };

struct slang_reading {
    struct slang *slang;
    const struct dt_log *log;
    const char *stage; /* macro of the stage whose lines these are; NULL: of both */
    unsigned depth;
};

char *slang_path(const char *from, const char *name)
{
    const char *slash = strrchr(from, '/');
    char *path = *name == '/' || !slash ? format_string("%s", name)
                                        : format_string("%.*s/%s", (int)(slash - from), from, name);
    for (char *at = path; at && *at; at++) /* of Windows */
        if (*at == '\\')
            *at = '/';
    return path;
}

/* ---- Pragmas --------------------------------------------------------------------------------- */

/* R16G16_SFLOAT is rg16f. */
static const char *format_named(const char *name)
{
    static const struct {
        const char *vulkan, *ours;
    } formats[] = {{"R8_UNORM", "r8"},
                   {"R8_UINT", "r8ui"},
                   {"R8_SINT", "r8i"},
                   {"R8G8_UNORM", "rg8"},
                   {"R8G8_UINT", "rg8ui"},
                   {"R8G8_SINT", "rg8i"},
                   {"R8G8B8A8_UNORM", "rgba8"},
                   {"R8G8B8A8_UINT", "rgba8ui"},
                   {"R8G8B8A8_SINT", "rgba8i"},
                   {"R8G8B8A8_SRGB", "rgba8_srgb"},
                   {"A2B10G10R10_UNORM_PACK32", "rgb10a2"},
                   {"R16_UINT", "r16ui"},
                   {"R16_SINT", "r16i"},
                   {"R16_SFLOAT", "r16f"},
                   {"R16G16_UINT", "rg16ui"},
                   {"R16G16_SINT", "rg16i"},
                   {"R16G16_SFLOAT", "rg16f"},
                   {"R16G16B16A16_UINT", "rgba16ui"},
                   {"R16G16B16A16_SINT", "rgba16i"},
                   {"R16G16B16A16_SFLOAT", "rgba16f"},
                   {"R32_UINT", "r32ui"},
                   {"R32_SINT", "r32i"},
                   {"R32_SFLOAT", "r32f"},
                   {"R32G32_UINT", "rg32ui"},
                   {"R32G32_SINT", "rg32i"},
                   {"R32G32_SFLOAT", "rg32f"},
                   {"R32G32B32A32_UINT", "rgba32ui"},
                   {"R32G32B32A32_SINT", "rgba32i"},
                   {"R32G32B32A32_SFLOAT", "rgba32f"}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(formats); i++)
        if (!strcmp(formats[i].vulkan, name))
            return formats[i].ours;
    return NULL;
}

/* IDENTIFIER "DESCRIPTION" INITIAL MINIMUM MAXIMUM [STEP]; the first of a name counts. */
static bool add_param(struct slang *slang, const char *line)
{
    struct slang_param param = {.step = 0};
    int fields = sscanf(line, "%127s \"%255[^\"]\" %lf %lf %lf %lf", param.name, param.doc,
                        &param.value, &param.min, &param.max, &param.step);
    for (uint32_t i = 0; i < slang->param_count; i++)
        if (!strcmp(slang->params[i].name, param.name))
            return true;
    struct slang_param *all =
        fields < 5 ? NULL : realloc(slang->params, (slang->param_count + 1) * sizeof *all);
    if (!all)
        return false;
    slang->params = all;
    all[slang->param_count++] = param;
    return true;
}

static void begin_stage(struct slang_reading *reading, const char *stage)
{
    struct text *out = &reading->slang->text;
    if (reading->stage)
        text_add(out, "#endif\n");
    text_add(out, "#ifdef %s\n", stage);
    reading->stage = stage;
}

/* `line`: behind #pragma. False: *why. */
static bool read_pragma(struct slang_reading *reading, const char *line, const char **why)
{
    struct slang *slang = reading->slang;
    char word[32] = "", argument[128] = "";
    sscanf(line, "%31s %127s", word, argument);
    if (!strcmp(word, "stage") && (!strcmp(argument, "vertex") || !strcmp(argument, "fragment"))) {
        begin_stage(reading, *argument == 'v' ? "VERTEX" : "FRAGMENT");
        return true;
    }
    text_add(&slang->text, "\n");
    if (!strcmp(word, "stage"))
        *why = "a stage is vertex or fragment";
    else if (!strcmp(word, "name"))
        snprintf(slang->name, sizeof slang->name, "%s", argument);
    else if (!strcmp(word, "parameter") && !add_param(slang, strstr(line, word) + strlen(word)))
        *why = "#pragma parameter needs NAME \"DESCRIPTION\" INITIAL MINIMUM MAXIMUM";
    else if (!strcmp(word, "format") && !(slang->format = format_named(argument)))
        *why = "images do not have this format";
    return !*why;
}

/* ---- Lines ----------------------------------------------------------------------------------- */

static bool read_file(struct slang_reading *reading, const char *path);

/* The word behind `#` and blanks; NULL: another line. */
static const char *directive(const char *line, const char *word)
{
    line += strspn(line, " \t");
    if (*line != '#')
        return NULL;
    line += 1 + strspn(line + 1, " \t");
    return !strncmp(line, word, strlen(word)) ? line + strlen(word) : NULL;
}

static bool read_include(struct slang_reading *reading, const char *from, const char *rest,
                         bool optional, const char **why)
{
    const char *quote = strchr(rest, '"');
    char name[1024];
    if (!quote || sscanf(quote, "\"%1023[^\"]\"", name) != 1) {
        *why = "#include needs a name in quotes";
        return false;
    }
    char *path = slang_path(from, name);
    bool there = path && file_exists(path), good = there || optional;
    if (!good)
        *why = "the included file cannot be read";
    else if (there && ++reading->depth > MOST_DEPTH)
        *why = "files include each other";
    else if (there)
        good = read_file(reading, path);
    reading->depth -= there;
    free(path);
    return good && !*why;
}

static bool read_line(struct slang_reading *reading, const char *path, const char *line,
                      const char **why)
{
    const char *include = directive(line, "include"), *pragma = directive(line, "pragma");
    const char *optional = pragma ? strstr(pragma, "include_optional") : NULL;
    if (include)
        return read_include(reading, path, include, false, why);
    if (optional)
        return read_include(reading, path, optional, true, why);
    if (pragma)
        return read_pragma(reading, pragma, why);
    text_add(&reading->slang->text, "%s\n", line);
    return true;
}

static bool read_file(struct slang_reading *reading, const char *path)
{
    size_t size = 0;
    char *all = file_read(path, &size, reading->log), *rest = all, *line;
    bool good = all;
    for (unsigned number = 1; good && (line = strsep(&rest, "\n")); number++) {
        const char *why = NULL;
        line[strcspn(line, "\r")] = 0;
        good = read_line(reading, path, line, &why);
        if (why)
            report_error(reading->log, "%s:%u: %s", path, number, why);
    }
    free(all);
    return good;
}

bool slang_read(const char *path, struct slang *slang, const struct dt_log *log)
{
    struct slang_reading reading = {.slang = slang, .log = log};
    *slang = (struct slang){0};
    bool good = read_file(&reading, path);
    if (good && !reading.stage)
        report_error(log, "%s: there is no #pragma stage", path);
    if (good && reading.stage)
        text_add(&slang->text, "#endif\n");
    return good && reading.stage && !slang->text.failed;
}

void slang_free(struct slang *slang)
{
    text_free(&slang->text);
    free(slang->params);
    *slang = (struct slang){0};
}
