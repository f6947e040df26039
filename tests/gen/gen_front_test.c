/* The front half of diptych-gen below the command line: expressions (values, overflow, text),
 * suggestions, growing text, passes that are off for good, and outputs that appear whole or not at
 * all. */
#include "tests/lib/unit.h"
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "model/expr.h"
#include "base/nearest.h"
#include "check/check.h"
#include "print/output.h"
#include "print/print.h"
#include "read/read.h"

static struct param params[] = {
    {.name = "n", .type = DT_TYPE_INT, .components = 1, .value = {8}},
    {.name = "tile", .type = DT_TYPE_IVEC2, .components = 2, .value = {4, 3}},
    {.name = "live", .type = DT_TYPE_INT, .components = 1, .value = {2}, .live = true},
    {.name = "flag", .type = DT_TYPE_BOOL, .components = 1, .value = {1}, .live = true},
    {.name = "block", .type = DT_TYPE_INT, .components = 1, .value = {3}, .uniform = true},
    {.name = "ratio", .type = DT_TYPE_FLOAT, .components = 1, .value = {0.5}},
};

struct fixture {
    struct model model;
    struct diag *diag;
};

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    f->model.arena = arena_create();
    f->diag = diag_create();
    f->model.pipeline.params = params;
    f->model.pipeline.param_count = 6;
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    diag_free(f->diag);
    arena_free(f->model.arena);
    free(f);
    return 0;
}

static struct expr *parse(struct fixture *f, const char *text)
{
    struct expr *expr = expr_parse(&f->model, text, (struct loc){0}, NULL, f->diag);
    return expr && expr_resolve(expr, &f->model.pipeline, f->diag) ? expr : NULL;
}

static int64_t value_of(struct fixture *f, const char *text)
{
    int64_t value;
    struct expr *expr = parse(f, text);
    assert_non_null(expr);
    assert_int_equal(expr_eval(expr, 1920, 1080, &value), EXPR_OK);
    return value;
}

TEST_WITH(values, setup, teardown)
{
    struct fixture *f = *state;
    assert_int_equal(value_of(f, "2 + 3 * 4"), 14);
    assert_int_equal(value_of(f, "(2 + 3) * 4"), 20);
    assert_int_equal(value_of(f, "20 - 5 - 3"), 12);
    assert_int_equal(value_of(f, "-7 / 2"), -3);
    assert_int_equal(value_of(f, "7 % 4"), 3);
    assert_int_equal(value_of(f, "-7 >> 1"), -4);
    assert_int_equal(value_of(f, "1 << 1 + 2 < 9 && 40 >> 1 >> 2 == 5"), 1);
    assert_int_equal(value_of(f, "n / tile.y + tile.x"), 6);
    assert_int_equal(value_of(f, "frame.width * frame.height"), 1920 * 1080);
    assert_int_equal(value_of(f, "ceil_div(frame.width, 7)"), 275);
    assert_int_equal(value_of(f, "min(n, 3) + max(n, 30)"), 33);
    assert_int_equal(value_of(f, "n > 4 ? 10 : 20"), 10);
    assert_int_equal(value_of(f, "1 || 1 / 0"), 1);
    assert_int_equal(value_of(f, "0 && 1 / 0"), 0);
    assert_int_equal(value_of(f, "!n == 0"), 1);
    assert_int_equal(value_of(f, "1 < 2 && 2 <= 2 && 3 != 4 && 4 >= 4 && true"), 1);
    assert_int_equal(value_of(f, "9223372036854775807"), INT64_MAX);
    assert_int_equal(diag_error_count(f->diag), 0);
}

TEST_WITH(faults, setup, teardown)
{
    static const struct {
        const char *text;
        enum expr_result result;
    } cases[] = {
        {"1 / (n - 8)", EXPR_DIVIDES_BY_ZERO},
        {"1 % 0", EXPR_DIVIDES_BY_ZERO},
        {"ceil_div(1, 0)", EXPR_DIVIDES_BY_ZERO},
        {"9223372036854775807 + 1", EXPR_OVERFLOWS},
        {"-9223372036854775807 - 2", EXPR_OVERFLOWS},
        {"4294967296 * 4294967296", EXPR_OVERFLOWS},
        {"4294967296 << 31", EXPR_OVERFLOWS},
        {"1 << 32", EXPR_OVERFLOWS},
        {"1 >> -1", EXPR_OVERFLOWS},
        {"-(-9223372036854775807 - 1)", EXPR_OVERFLOWS},
        {"(-9223372036854775807 - 1) / -1", EXPR_OVERFLOWS},
    };
    struct fixture *f = *state;
    int64_t value;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct expr *expr = parse(f, cases[i].text);
        assert_non_null(expr);
        assert_int_equal(expr_eval(expr, 1, 1, &value), cases[i].result);
    }
}

TEST_WITH(refusals, setup, teardown)
{
    static const char *const cases[] = {
        "",    "1 +",    "(1",     "1 2",         "x",
        "n.x", "tile",   "tile.z", "ratio",       "0.5",
        "1e3", "min(1)", "frame",  "frame.depth", "99999999999999999999",
        "a b", "$",      "n.",     "1 ? 2"};
    struct fixture *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned before = diag_error_count(f->diag);
        assert_null(parse(f, cases[i]));
        assert_int_equal(diag_error_count(f->diag), before + 1);
    }
    char deep[400];
    memset(deep, '(', sizeof deep - 1);
    deep[sizeof deep - 1] = '\0';
    assert_null(parse(f, deep));
}

TEST_WITH(reach_and_text, setup, teardown)
{
    static const struct {
        const char *text;
        unsigned reach;
        const char *c, *glsl;
    } cases[] = {
        {"n * 2", EXPR_BAKED, "16", "16"},
        {"frame.width + n", EXPR_FRAME, "(int64_t)width + 8", "int(frame.width) + 8"},
        {"live > 1", EXPR_LIVE, "((int64_t)live->live > 1)", "int(live > 1)"},
        {"0 && live > 1", EXPR_BAKED, "0", "0"},
        {"n == 8 || live > 1", EXPR_BAKED, "1", "1"},
        {"n == 8 ? 3 : live", EXPR_BAKED, "3", "3"},
        {"n == 8 && live > 1", EXPR_LIVE, "((int64_t)live->live > 1)", "int(live > 1)"},
        {"live || n < 8", EXPR_LIVE, "((int64_t)live->live != 0)", "int(live != 0)"},
        {"n < 8 && block", EXPR_BAKED, "0", "int((false) && (block != 0))"},
        {"n == 8 && block", EXPR_BAKED, "1", "int(block != 0)"},
        {"min(live, 3)", EXPR_LIVE, "((int64_t)live->live < 3 ? (int64_t)live->live : 3)",
         "min(live, 3)"},
        {"live && frame.height", EXPR_LIVE | EXPR_FRAME,
         "(((int64_t)live->live != 0) && ((int64_t)height != 0))",
         "int((live != 0) && (int(frame.height) != 0))"},
    };
    struct fixture *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct text c = {0}, glsl = {0};
        struct expr *expr = parse(f, cases[i].text);
        assert_non_null(expr);
        assert_int_equal(expr_reach(expr), cases[i].reach);
        expr_emit_c(expr, &c);
        expr_emit_glsl(expr, &glsl);
        assert_string_equal(c.data, cases[i].c);
        assert_string_equal(glsl.data, cases[i].glsl);
        text_free(&c);
        text_free(&glsl);
    }
}

TEST_WITH(conditions_in_c, setup, teardown)
{
    static const struct {
        const char *text, *c;
    } cases[] = {
        {"live", "(int64_t)live->live != 0"},
        {"flag", "live->flag != 0"},
        {"flag == 1", "(live->flag != 0) == 1"},
        {"live > 1 && n > 0", "(int64_t)live->live > 1"},
        {"live > 1 && flag", "((int64_t)live->live > 1) && (live->flag != 0)"},
        {"!(n < 0 || flag)", "!(live->flag != 0)"},
        {"n > 0", "true"},
        {"n < 0 && live", "false"},
    };
    struct fixture *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct text c = {0};
        struct expr *expr = parse(f, cases[i].text);
        assert_non_null(expr);
        expr_emit_c_condition(expr, &c);
        assert_string_equal(c.data, cases[i].c);
        text_free(&c);
    }
}

TEST(nearest)
{
    static const char *const words[] = {"clusters", "bounces", "tile", "x"};
    assert_string_equal(nearest_name("clutsers", words, 4), "clusters");
    assert_string_equal(nearest_name("Tile", words, 4), "tile");
    assert_string_equal(nearest_name("bonuces", words, 4), "bounces");
    assert_null(nearest_name("picture", words, 4));
    assert_null(nearest_name("q", words, 4));
    assert_null(nearest_name("anything", words, 0));
}

TEST(growing_text)
{
    struct text text = {0};
    for (int i = 0; i < 1000; i++)
        text_add(&text, "%03d,", i);
    assert_int_equal(text.length, 4000);
    assert_memory_equal(text.data + 3992, "998,999,", 9);
    text_add_bytes(&text, "\0x", 2);
    assert_int_equal(text.length, 4002);
    assert_false(text.failed);
    text_free(&text);
    assert_null(text.data);
}

/* ---- Passes that are off --------------------------------------------------------------------- */

static void write_file(const char *dir, const char *name, const char *text)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0 && fclose(file) == 0);
}

/* Names of the passes that the later stages get. */
static void kept_passes(const char *spec, char kept[256])
{
    struct model model = {.arena = arena_create(), .templates_dir = "templates"};
    struct diag *diag = diag_create();
    bool good =
        read_spec(&model, spec, NULL, 0, diag) && check_model(&model, model.templates_dir, diag);
    if (!good)
        diag_print(diag, "diptych-gen", stderr);
    assert_true(good);
    kept[0] = '\0';
    for (uint32_t i = 0; i < model.pipeline.pass_count; i++)
        snprintf(kept + strlen(kept), 256 - strlen(kept), "%s%s", i ? " " : "",
                 model.pipeline.passes[i].name);
    diag_free(diag);
    arena_free(model.arena);
}

/* A skipped pass clears the resources that it would write. A pass that is always skipped is left
 * out. It stays where a remaining pass reads these clear values and no other pass writes them. The
 * reader may be an always skipped pass that stays for the same reason. */
TEST(off_for_good)
{
    static const char head[] = "pipeline: off\n"
                               "params: {on: 0, live_on: {value: 0, live: true}}\n"
                               "structs: {Arguments: {x: uint, y: uint, z: uint}}\n"
                               "buffers: {a: {of: uint, count: 4}, b: {of: uint, count: 4},\n"
                               "  arguments: {of: Arguments, count: 1}}\n"
                               "images: {shown: {format: rgba8, size: frame},\n"
                               "  glow: {format: r32f, size: [8, 8], mips: 2}}\n"
                               "output: {display: shown}\npasses:\n";
    static const char make[] = "name: make, when: on, dispatch: 4, writes: [a]";
    static const char hand_on[] = "name: hand_on, when: on, dispatch: 4, reads: [a], writes: [b]";
    static const char show[] = "name: show, dispatch: shown, writes: [shown]";
    static const char show_a[] = "name: show, dispatch: shown, reads: [a], writes: [shown]";
    static const char show_b[] = "name: show, dispatch: shown, reads: [b], writes: [shown]";
    static const struct {
        const char *passes[3], *kept;
    } cases[] = {
        {{make, show_a}, "make show"},
        {{make, show}, "show"},
        {{"name: make, when: live_on, dispatch: 4, writes: [a]", show}, "make show"},
        {{make, "name: other, dispatch: 4, writes: [a], after: [make]", show_a}, "other show"},
        {{make, hand_on, show_b}, "make hand_on show"},
        {{make, "name: add, dispatch: 4, updates: [a]", show_a}, "make add show"},
        {{"name: make, when: on, dispatch: glow, writes: [glow]",
          "name: halve, dispatch: glow, reads: [glow], writes: [{name: glow, mip: 1, as: coarser}]",
          show},
         "make halve show"},
        {{make, hand_on, show}, "show"},
        {{"name: make, when: on, dispatch: 1, writes: [arguments]",
          "name: show, indirect: arguments, reads: [arguments], writes: [shown]"},
         "make show"},
    };
    char dir[] = "/tmp/gen_front_XXXXXX", spec[256], text[2048], kept[256], command[300];
    (void)state;
    assert_non_null(mkdtemp(dir));
    write_file(dir, "none.glsl", "void main() {}\n");
    snprintf(spec, sizeof spec, "%s/off.yaml", dir);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t used = (size_t)snprintf(text, sizeof text, "%s", head);
        for (size_t k = 0; k < 3 && cases[i].passes[k]; k++)
            used += (size_t)snprintf(text + used, sizeof text - used,
                                     "  - {%s, shader: none.glsl}\n", cases[i].passes[k]);
        write_file(dir, "off.yaml", text);
        kept_passes(spec, kept);
        assert_string_equal(kept, cases[i].kept);
    }
    snprintf(command, sizeof command, "rm -rf '%s'", dir);
    assert_int_equal(system(command), 0);
}

/* ---- Output ---------------------------------------------------------------------------------- */

static void add(struct output *output, const char *dir, const char *name, const char *content)
{
    struct text text = {0};
    text_add(&text, "%s", content);
    output_add(output, dir, name, &text);
}

static bool commit(const char *dir, const char *first, const char *second_name, const char *second)
{
    struct output *output = output_create();
    add(output, dir, "first", first);
    add(output, dir, second_name, second);
    bool good = output_commit(output);
    output_free(output);
    return good;
}

static const char *content(const char *dir, const char *name)
{
    static char buffer[64];
    char path[256];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *file = fopen(path, "rb");
    if (!file)
        return "absent";
    buffer[fread(buffer, 1, sizeof buffer - 1, file)] = '\0';
    fclose(file);
    return buffer;
}

static int entries(const char *dir)
{
    char command[300];
    int count = -1;
    snprintf(command, sizeof command, "find '%s' -type f | wc -l", dir);
    FILE *pipe = popen(command, "r");
    if (!pipe || fscanf(pipe, "%d", &count) != 1)
        count = -1;
    if (pipe)
        pclose(pipe);
    return count;
}

TEST(outputs)
{
    char dir[] = "/tmp/gen_front_XXXXXX", path[256];
    assert_non_null(mkdtemp(dir));
    assert_true(commit(dir, "1", "sub/second", "2"));
    assert_string_equal(content(dir, "first"), "1");
    assert_string_equal(content(dir, "sub/second"), "2");

    /* unchanged files keep their time stamp; changed ones do not */
    struct timespec old[2] = {{1000, 0}, {1000, 0}};
    struct stat status;
    snprintf(path, sizeof path, "%s/first", dir);
    assert_int_equal(utimensat(AT_FDCWD, path, old, 0), 0);
    assert_true(commit(dir, "1", "sub/second", "3"));
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mtim.tv_sec, 1000);
    assert_string_equal(content(dir, "sub/second"), "3");

    /* the second cannot be written (a file stands where its folder should be; a folder where the
     * file should be): the first stays as it was, and nothing is left behind */
    assert_false(commit(dir, "new", "first/second", "2"));
    assert_string_equal(content(dir, "first"), "1");
    snprintf(path, sizeof path, "%s/folder", dir);
    assert_int_equal(mkdir(path, 0777), 0);
    assert_false(commit(dir, "new", "folder", "2"));
    assert_string_equal(content(dir, "first"), "1");
    assert_int_equal(entries(dir), 2);

    if (geteuid() != 0) { /* root writes anywhere */
        assert_int_equal(chmod(path, 0555), 0);
        assert_false(commit(dir, "new", "folder/second", "2"));
        assert_string_equal(content(dir, "first"), "1");
    }
    char command[300];
    snprintf(command, sizeof command, "rm -rf '%s'", dir);
    assert_int_equal(system(command), 0);
}

RUN_TESTS("gen_front", NULL, NULL)
