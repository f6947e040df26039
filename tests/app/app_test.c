/* The parts of the command line that need no device: options, files, numbers in resources,
 * live parameters, pictures, dumps. Expected values come from IEEE 754 and sRGB. */
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <OpenEXR/ImfCRgbaFile.h>
#include "tests/lib/unit.h"
#include "app/console/console.h"
#include "base/files.h"
#include "app/picture/hdr.h"
#include "app/console/spread.h"
#include "app/result/live.h"
#include "app/console/options.h"
#include "app/picture/texels.h"
#include "app/result/dump.h"
#include "app/picture/picture.h"

/* ---- Log ------------------------------------------------------------------------------------- */

struct ear {
    char last[512];
    int errors;
};

static void hear(void *user, enum dt_level level, const char *message)
{
    struct ear *ear = user;
    ear->errors += level == DT_ERROR;
    snprintf(ear->last, sizeof ear->last, "%s", message);
}

static struct dt_log log_to(struct ear *ear)
{
    *ear = (struct ear){.errors = 0};
    return (struct dt_log){.message = hear, .user = ear};
}

/* ---- Options --------------------------------------------------------------------------------- */

static const struct verb render = {.name = "render", .id = VERB_RENDER};

static bool parse(struct options *options, struct ear *ear, int count, const char *const *words)
{
    const struct dt_log log = log_to(ear);
    return options_parse(options, &render, count, (char **)words, &log);
}

TEST(options_are_read)
{
    const char *words[] = {"--scene", "a.yaml",     "--backend=vk", "-o",  "x.png",
                           "--size",  "640x480",    "--set",        "a=1", "--set",
                           "b=x=y",   "--frames=7", "--debug"};
    struct options options;
    struct ear ear;
    assert_true(parse(&options, &ear, DT_ARRAY_COUNT(words), words));
    assert_string_equal(options.setup.scene, "a.yaml");
    assert_string_equal(options.setup.backend, "vk");
    assert_int_equal(options.setup.size[0], 640);
    assert_int_equal(options.setup.size[1], 480);
    assert_int_equal(options.setup.set_count, 2);
    assert_string_equal(options.setup.sets[1], "b=x=y");
    assert_int_equal(options.setup.frames, 7);
    assert_true(options.setup.debug);
    assert_false(options.setup.glsl);
    options_free(&options);
}

TEST(wrong_options_are_refused)
{
    static const struct {
        const char *words[4];
        const char *said;
    } cases[] = {
        {{"--sceen", "x"}, "did you mean \"--scene\"?"},
        {{"--spp", "1"}, "unknown option \"--spp\""}, /* of another verb */
        {{"--size", "0x4"}, "--size 0x4"},
        {{"--size", "4x4x"}, "--size 4x4x"},
        {{"--size", "-4x4"}, "--size -4x4"},
        {{"--frames", "1e3"}, "--frames 1e3"},
        {{"--frames", "99999999999999999999"}, "--frames"},
        {{"--context", "x"}, "must be one of egl|"},
        {{"--set", "novalue"}, "PATH=VALUE"},
        {{"--set", "=1"}, "PATH=VALUE"},
        {{"--debug=yes", NULL}, "takes no value"},
        {{"--spec", NULL}, "is missing"},
        {{"stray", NULL}, "unexpected argument \"stray\""},
        {{"--scene", "x"}, "--backend NAME is missing"},
    };
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++) {
        int count = 0;
        while (count < 4 && cases[i].words[count])
            count++;
        struct options options;
        struct ear ear;
        assert_false(parse(&options, &ear, count, cases[i].words));
        assert_int_equal(ear.errors, 1);
        if (!strstr(ear.last, cases[i].said))
            fail_msg("\"%s\" does not say \"%s\"", ear.last, cases[i].said);
        options_free(&options);
    }
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* Values of xxHash's own xxhsum -H3. */
TEST(hash_is_xxh3)
{
    uint64_t hash = FILE_HASH_START;
    hash_bytes(&hash, "", 0);
    assert_true(hash == UINT64_C(0x2d06800538d394c2));
    hash = FILE_HASH_START;
    hash_bytes(&hash, "foobar", 6);
    assert_true(hash == UINT64_C(0xd78fda63144c5c84));
}

/* hash_file and hash_bytes give the same hash, also after earlier input, and for a file that takes
 * several reads. */
TEST(a_file_hashes_as_its_bytes)
{
    enum { SIZE = 200000 };
    static uint8_t bytes[SIZE];
    char path[] = "/tmp/diptych-XXXXXX";
    int file = mkstemp(path);
    for (size_t i = 0; i < SIZE; i++)
        bytes[i] = (uint8_t)(i * i >> 3);
    assert_int_equal(write(file, bytes, SIZE), SIZE);
    uint64_t of_file = FILE_HASH_START, of_bytes = FILE_HASH_START;
    for (int i = 0; i < 2; i++) {
        assert_true(hash_file(&of_file, path));
        hash_bytes(&of_bytes, bytes, SIZE);
        assert_true(of_file == of_bytes);
    }
    close(file);
    unlink(path);
    assert_false(hash_file(&of_file, path));
}

TEST(files_appear_whole)
{
    char folder[] = "/tmp/diptych-XXXXXX";
    assert_non_null(mkdtemp(folder));
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    char *deep = format_string("%s/a/b/c", folder);
    char *path = format_string("%s/file", deep);
    assert_false(file_write(path, "x", 1, &log));
    assert_int_equal(ear.errors, 1);
    assert_true(file_make_folders(deep, &log));
    assert_true(file_write(path, "one", 3, &log));
    assert_true(file_write(path, "three", 5, &log));
    size_t size;
    char *text = file_read(path, &size, &log);
    assert_int_equal(size, 5);
    assert_string_equal(text, "three");
    assert_true(file_remove_tree(folder));
    assert_false(file_exists(folder));
    assert_true(file_remove_tree(folder));
    free(text);
    free(path);
    free(deep);
}

/* Writing follows a link into another folder, keeps the mode of a file, and writes into a pipe.
 * Users link scenes, protect files, and send --json into a pipe. */
TEST(files_keep_their_place)
{
    char folder[] = "/tmp/diptych-XXXXXX", got[8] = "";
    assert_non_null(mkdtemp(folder));
    char *file = format_string("%s/file", folder), *link = format_string("%s/link", folder);
    char *pipe = format_string("%s/pipe", folder);
    struct stat status;
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    assert_true(file_write(file, "old", 3, &log));
    assert_int_equal(chmod(file, 0640), 0);
    assert_int_equal(symlink("file", link), 0);
    assert_true(file_can_write(link, &log) && file_write(link, "new!", 4, &log));
    assert_int_equal(lstat(link, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(stat(file, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
    assert_int_equal(status.st_size, 4);
    assert_int_equal(mkfifo(pipe, 0600), 0);
    int end = open(pipe, O_RDONLY | O_NONBLOCK);
    assert_true(end >= 0 && file_can_write(pipe, &log) && file_write(pipe, "said", 4, &log));
    assert_int_equal(read(end, got, sizeof got), 4);
    assert_memory_equal(got, "said", 4);
    assert_int_equal(lstat(pipe, &status), 0);
    assert_true(S_ISFIFO(status.st_mode));
    assert_int_equal(ear.errors, 0);
    close(end);
    file_remove_tree(folder);
    free(pipe);
    free(link);
    free(file);
}

TEST(drafts_become_files_whole)
{
    char folder[] = "/tmp/diptych-XXXXXX";
    assert_non_null(mkdtemp(folder));
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    struct file_draft draft;
    char *path = format_string("%s/file", folder);
    assert_true(file_draft_begin(&draft, &log));
    fprintf(draft.out, "%d lines\n", 1);
    assert_false(file_exists(path));
    assert_true(file_draft_end(&draft, path, &log));
    size_t size;
    char *text = file_read(path, &size, &log);
    assert_string_equal(text, "1 lines\n");
    assert_true(file_draft_begin(&draft, &log));
    assert_false(file_draft_end(&draft, path, &log)); /* an empty draft: the old file stays */
    assert_int_equal(ear.errors, 1);
    assert_true(file_exists(path));
    assert_true(file_draft_begin(&draft, &log));
    fputs("lost", draft.out);
    file_draft_discard(&draft);
    assert_false(file_draft_end(&draft, path, &log)); /* a discarded draft: no second error */
    assert_int_equal(ear.errors, 1);
    file_remove_tree(folder);
    free(text);
    free(path);
}

/* ---- Numbers --------------------------------------------------------------------------------- */

TEST(medians_leave_out_gaps)
{
    static const double odd[] = {5, 1, 3}, even[] = {4, 1, 3, 2}, gaps[] = {NAN, NAN},
                        table[] = {7, 100, NAN, 200, 9, 300, 8, 400};
    assert_float_equal(median_of(odd, 3, 1), 3, 0);
    assert_float_equal(median_of(even, 4, 1), 2.5, 0);
    assert_float_equal(median_of(table, 4, 2), 8, 0);
    assert_float_equal(median_of(table + 1, 4, 2), 250, 0);
    assert_true(isnan(median_of(gaps, 2, 1)) && isnan(median_of(gaps, 0, 1)));
}

/* Letters before the bits are channels; packed formats have bits behind each letter. */
TEST(formats_are_what_their_names_say)
{
    for (int i = 0; i < DT_FORMAT_COUNT; i++) {
        const struct format_info *info = format_info((enum dt_format)i);
        size_t letters = strspn(info->name, "rgbad");
        uint32_t bits = (uint32_t)strtoul(info->name + letters, NULL, 10);
        const char *end = info->name + strcspn(info->name, "_ui");
        if (number_is_packed(info->kind)) {
            assert_int_equal(info->bytes, 4);
            continue;
        }
        assert_int_equal(info->channels, letters);
        assert_int_equal(8 * info->bytes, bits * letters);
        assert_int_equal(number_width(info->kind), bits);
        assert_int_equal(number_is_integer(info->kind), !strcmp(end, "i") || !strcmp(end, "ui"));
        assert_int_equal(number_is_signed_integer(info->kind), !strcmp(end, "i"));
        assert_int_equal(info->kind == NUMBER_SNORM16, !strcmp(end, "_snorm"));
        assert_int_equal(number_is_float(info->kind), strchr(info->name, 'f') != NULL);
        assert_true(!info->qualifier || !strcmp(info->qualifier, info->name));
    }
}

TEST(halves_are_ieee)
{
    static const struct {
        uint16_t bits;
        double value;
    } cases[] = {{0x0000, 0},       {0x3c00, 1},         {0xc000, -2},
                 {0x7bff, 65504},   {0x0001, 0x1p-24},   {0x03ff, 1023 * 0x1p-24},
                 {0x0400, 0x1p-14}, {0x3555, 0x1.554p-2}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(cases); i++)
        assert_true(number_value(NUMBER_HALF, (const uint8_t *)&cases[i].bits) == cases[i].value);
    const uint16_t infinite = 0xfc00;
    const uint16_t nan = 0x7e00;
    assert_true(number_value(NUMBER_HALF, (const uint8_t *)&infinite) == -INFINITY);
    const struct {
        enum number_kind kind;
        uint16_t bits;
        double value;
    } codes[] = {{NUMBER_UNORM16, 13107, 0.2},   {NUMBER_UNORM16, 65535, 1},
                 {NUMBER_SNORM16, 32767, 1},     {NUMBER_SNORM16, 0x8001, -1},
                 {NUMBER_UINT8, 200, 200},       {NUMBER_INT8, 200, -56},
                 {NUMBER_UINT16, 0x8001, 32769}, {NUMBER_INT16, 0x8001, -32767}};
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
        uint16_t stored = 0;
        assert_true(number_value(codes[i].kind, (const uint8_t *)&codes[i].bits) == codes[i].value);
        assert_true(number_store(codes[i].kind, codes[i].value, (uint8_t *)&stored));
        assert_int_equal(stored, codes[i].bits);
        assert_false(number_store(codes[i].kind, 65536, (uint8_t *)&stored));
    }
    const struct {
        enum number_kind kind;
        uint32_t texel; /* with other channels beside */
        double value, beyond;
    } packed[] = {{NUMBER_R11F, 0xfffffbc0, 1, 65280},
                  {NUMBER_G11F, 0xffc007ff, 0, -1},
                  {NUMBER_G11F, 0xffc00fff, 0x1p-20, 65536},
                  {NUMBER_B10F, 0xf7ffffff, 64512, 65024},
                  {NUMBER_R10, 0xffffffff, 1, 1.01},
                  {NUMBER_G10, 0xfff033ff, 12 / 1023.0, -1},
                  {NUMBER_B10, 0xc00fffff, 0, 2},
                  {NUMBER_A2, 0x7fffffff, 1 / 3.0, 2}};
    for (size_t i = 0; i < sizeof packed / sizeof *packed; i++) {
        uint32_t stored = packed[i].texel;
        assert_true(number_value(packed[i].kind, (uint8_t *)&stored) == packed[i].value);
        assert_false(number_store(packed[i].kind, packed[i].beyond, (uint8_t *)&stored));
        number_set_bits(packed[i].kind, 1, (uint8_t *)&stored);
        assert_true(number_store(packed[i].kind, packed[i].value, (uint8_t *)&stored));
        assert_int_equal(stored, packed[i].texel);
    }
    const uint16_t least = 0x8000; /* snorm has two codes of -1 */
    assert_true(number_value(NUMBER_SNORM16, (const uint8_t *)&least) == -1);
    assert_true(isnan(number_value(NUMBER_HALF, (const uint8_t *)&nan)));
}

/* A number is stored as the nearest half or code. A tie goes to the even half. */
TEST(numbers_are_stored_to_the_nearest)
{
    uint16_t stored;
    uint8_t code;
    for (uint32_t bits = 0; bits < 0x7bff; bits++) {
        uint16_t low = (uint16_t)bits, high = (uint16_t)(bits + 1);
        double a = number_value(NUMBER_HALF, (const uint8_t *)&low);
        double b = number_value(NUMBER_HALF, (const uint8_t *)&high);
        double near_a = a + 0.49 * (b - a), near_b = a + 0.51 * (b - a), between = a + (b - a) / 2;
        assert_true(number_store(NUMBER_HALF, a, (uint8_t *)&stored) && stored == low);
        assert_true(number_store(NUMBER_HALF, near_a, (uint8_t *)&stored) && stored == low);
        assert_true(number_store(NUMBER_HALF, near_b, (uint8_t *)&stored) && stored == high);
        assert_true(number_store(NUMBER_HALF, -between, (uint8_t *)&stored));
        assert_int_equal(stored, 0x8000 | (bits & 1 ? high : low));
    }
    assert_true(number_store(NUMBER_HALF, 65519, (uint8_t *)&stored) && stored == 0x7bff);
    assert_false(number_store(NUMBER_HALF, 65520, (uint8_t *)&stored));
    assert_false(number_store(NUMBER_HALF, (double)NAN, (uint8_t *)&stored));
    for (int i = 0; i < 256; i++)
        assert_true(number_store(NUMBER_UNORM8, i / 255.0, &code) && code == i);
    assert_false(number_store(NUMBER_UNORM8, 1.0001, &code));
    assert_false(number_store(NUMBER_UNORM8, -0.0001, &code));
}

TEST(components_are_named)
{
    static const struct dt_field fields[] = {{"flux", DT_TYPE_VEC3, 0, 0, 0},
                                             {"cluster", DT_TYPE_UINT, 12, 0, 0},
                                             {"table", DT_TYPE_VEC2, 16, 2, 8}};
    const struct dt_resource resource = {
        .name = "r", .kind = DT_BUFFER, .fields = fields, .field_count = 3, .stride = 32};
    struct component *list;
    assert_int_equal(resource_components(&resource, &list), 8);
    assert_string_equal(list[1].name, "flux.y");
    assert_string_equal(list[3].name, "cluster");
    assert_int_equal(list[3].kind, NUMBER_UINT);
    assert_string_equal(list[7].name, "table[1].y");
    assert_int_equal(list[7].offset, 28);
    free(list);
}

/* ---- Live parameters ------------------------------------------------------------------------- */

TEST(live_parameters_are_checked)
{
    static const struct dt_param params[] = {
        {.name = "bounces", .type = DT_TYPE_UINT, .live = true, .offset = 4, .min = 0, .max = 2},
        {.name = "tint", .type = DT_TYPE_VEC2, .live = true, .offset = 8, .min = -1, .max = 1},
        {.name = "on",
         .type = DT_TYPE_BOOL,
         .live = true,
         .offset = 0,
         .min = -INFINITY,
         .max = INFINITY},
        {.name = "far", .type = DT_TYPE_FLOAT, .offset = 0, .min = -INFINITY, .max = INFINITY},
    };
    static const struct dt_pipeline info = {
        .name = "p", .params = params, .param_count = 4, .live_size = 16};
    uint32_t live[4] = {0};
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    assert_true(live_set(&info, live, live_param(&info, "bounces"), "2", &log));
    assert_true(live_set(&info, live, live_param(&info, "tint"), "[0.5, -1]", &log));
    assert_true(live_set(&info, live, live_param(&info, "on"), "true", &log));
    const uint32_t expected[4] = {1, 2, 0x3f000000, 0xbf800000};
    assert_memory_equal(live, expected, sizeof live);
    static const char *const wrong[] = {"3",  "1.5", "-1", "",    "x",
                                        "2x", "nan", "[1", "1,2", "[1, 2]"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(wrong); i++)
        assert_false(live_set(&info, live, &params[0], wrong[i], &log));
    assert_false(live_set(&info, live, &params[1], "1", &log));
    assert_false(live_set(&info, live, &params[2], "2", &log));
    assert_false(live_set(&info, live, &params[3], "-1e300", &log));
    assert_int_equal(ear.errors, (int)DT_ARRAY_COUNT(wrong) + 3);
    assert_memory_equal(live, expected, sizeof live);
    assert_null(live_param(&info, "absent"));
}

/* ---- Pictures -------------------------------------------------------------------------------- */

/* Every texel of a layered image has its own place in the sheet, which leads back to it. */
TEST(places_lead_to_texels)
{
    static const uint32_t extent[3] = {3, 2, 5}; /* a sheet of 3 x 2 layers */
    bool seen[9 * 4] = {false};
    for (uint64_t texel = 0; texel < 30; texel++) {
        uint32_t place[2];
        uint64_t back = 99;
        picture_place(extent, texel, place);
        assert_true(place[0] < 9 && place[1] < 4 && !seen[place[1] * 9 + place[0]]);
        seen[place[1] * 9 + place[0]] = true;
        assert_true(picture_texel(extent, place, &back));
        assert_int_equal(back, texel);
    }
    uint64_t none;
    assert_false(picture_texel(extent, (uint32_t[2]){8, 3}, &none)); /* of the sixth layer */
    assert_false(picture_texel(extent, (uint32_t[2]){9, 0}, &none));
}

/* A range makes its ends black and white, whatever the channel; NaN stays magenta in false colour. */
TEST(looks_have_ranges)
{
    const struct dt_resource resource = {
        .name = "r", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA32F, .mips = 1};
    float texels[3][4] = {{0, 0, 0, 10}, {0, 0, 0, 30}, {0, 0, 0, 20}};
    const struct dt_bytes bytes = {(uint8_t *)texels, sizeof texels, {3, 1, 1}};
    static const uint8_t expected[9] = {0, 0, 0, 255, 255, 255, 128, 128, 128};
    struct picture_look look = {.channel = 4, .ranged = true};
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    struct picture picture;
    picture_range(&resource, &bytes, 4, look.range);
    assert_true(look.range[0] == 10 && look.range[1] == 30);
    assert_true(picture_look(&picture, &resource, &bytes, &look, &log));
    assert_memory_equal(picture.codes, expected, sizeof expected);
    picture_free(&picture);
    texels[1][3] = NAN;
    look.tinted = true;
    assert_true(picture_look(&picture, &resource, &bytes, &look, &log));
    assert_memory_equal(picture.codes + 3, ((uint8_t[3]){255, 0, 255}), 3);
    assert_memory_not_equal(picture.codes, picture.codes + 6, 3);
    picture_free(&picture);
}

TEST(pictures_are_upright)
{
    uint8_t texels[2][2][4] = {{{1, 2, 3, 4}, {5, 6, 7, 8}}, {{9, 10, 11, 12}, {13, 14, 15, 16}}};
    const struct dt_resource resource = {.name = "i", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8};
    const struct dt_bytes bytes = {.data = &texels[0][0][0], .size = 16, .extent = {2, 2, 1}};
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    struct picture picture;
    assert_true(picture_codes(&picture, &resource, &bytes, &log));
    const uint8_t expected[] = {9, 10, 11, 13, 14, 15, 1, 2, 3, 5, 6, 7};
    assert_int_equal(picture.width, 2);
    assert_memory_equal(picture.codes, expected, sizeof expected);
    picture_free(&picture);
}

TEST(normals_become_colours)
{
    float texels[2][4] = {{-1, 0, 1, 0}, {NAN, 0, 0, 0}};
    const struct dt_resource resource = {
        .name = "n", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA32F};
    const struct dt_bytes bytes = {
        .data = (uint8_t *)texels, .size = sizeof texels, .extent = {2, 1, 1}};
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    struct picture picture;
    assert_true(picture_codes(&picture, &resource, &bytes, &log));
    const uint8_t expected[] = {0, 128, 255, 255, 0, 255};
    assert_memory_equal(picture.codes, expected, sizeof expected);
    picture_free(&picture);
}

TEST(layers_make_a_sheet)
{
    float texels[5] = {1, 2, 3, 4, 5};
    const struct dt_resource resource = {
        .name = "l", .kind = DT_IMAGE, .format = DT_FORMAT_R32F, .layered = true};
    const struct dt_bytes bytes = {
        .data = (uint8_t *)texels, .size = sizeof texels, .extent = {1, 1, 5}};
    struct ear ear;
    const struct dt_log log = log_to(&ear);
    struct picture picture;
    assert_true(picture_linear(&picture, &resource, &bytes, &log));
    assert_int_equal(picture.width, 3);
    assert_int_equal(picture.height, 2);
    assert_true(picture.linear[4 * 3] == 5);
    assert_true(picture.linear[5 * 3] == 0);
    picture_free(&picture);
    const struct dt_resource buffer = {.name = "b", .kind = DT_BUFFER};
    assert_false(picture_linear(&picture, &buffer, &bytes, &log));
    assert_non_null(strstr(ear.last, "b is a buffer"));
}

/* ---- Dumps ----------------------------------------------------------------------------------- */

TEST(dumps_replace_only_dumps)
{
    static const uint16_t writes[] = {0};
    static const struct dt_resource resource = {
        .name = "r", .kind = DT_IMAGE, .format = DT_FORMAT_R32F};
    static const struct dt_pass pass = {.name = "p", .writes = writes, .write_count = 1};
    const struct dt_pipeline info = {
        .name = "x", .resources = &resource, .resource_count = 1, .passes = &pass, .pass_count = 1};
    char folder[] = "/tmp/diptych-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *place = format_string("%s/dump", folder);
    char *raw = format_string("%s/00.p.r.raw", place);
    char *theirs = format_string("%s/letter", folder);
    struct ear ear;
    struct console console = {.log = log_to(&ear)};
    pthread_mutex_init(&console.lock, NULL);
    pthread_mutex_init(&console.writing, NULL);
    float number = 1;
    struct dt_bytes bytes = {.data = (uint8_t *)&number, .size = 4, .extent = {1, 1, 1}};
    for (int i = 0; i < 3; i++) { /* the first is thrown away, the third replaces the second */
        struct dump dump;
        assert_true(dump_begin(&dump, &console, &info, place));
        assert_true(dump_add(&dump, 0, 0, 0, &bytes));
        assert_true(dump_end(&dump, i > 0));
        assert_int_equal(file_exists(raw), i > 0);
    }
    assert_true(file_write(theirs, "dear", 4, &console.log));
    struct dump dump;
    assert_false(dump_begin(&dump, &console, &info, folder));
    dump_end(&dump, false);
    assert_int_equal(ear.errors, 1);
    assert_true(file_exists(theirs));
    file_remove_tree(folder);
    free(theirs);
    free(raw);
    free(place);
}

TEST(mips_hold_something_once_written)
{
    static const uint16_t first[] = {0, 1}, second[] = {0}, before[] = {2};
    static const uint16_t mips_1_and_2[] = {2 | 4};
    static const struct dt_resource resources[] = {
        {.name = "pyramid", .kind = DT_IMAGE, .mips = 3},
        {.name = "buffer", .kind = DT_BUFFER},
        {.name = "kept", .kind = DT_IMAGE, .mips = 3, .history = true}};
    static const struct dt_pass passes[] = {
        {.name = "p", .reads = before, .read_count = 1, .writes = first, .write_count = 2},
        {.name = "q", .writes = second, .write_count = 1, .write_mips = mips_1_and_2}};
    const struct dt_pipeline info = {.resources = resources, .passes = passes, .pass_count = 2};
    assert_int_equal(resource_mips_before(&info, 1, 0), 1);
    assert_int_equal(resource_mips_before(&info, 2, 0), 7);
    assert_int_equal(resource_mips_before(&info, 1, 1), 1);
    assert_int_equal(resource_mips_before(&info, 1, 2), 7);
    assert_int_equal(pass_mips(&passes[1], 0), 2 | 4);
}

/* ---- Messages -------------------------------------------------------------------------------- */

struct speaker {
    struct console *console;
    pthread_barrier_t *meeting;
    const char *name;
    char *text;
};

/* Both threads capture while each one reports its error, between the two meetings. */
static void *speak(void *user)
{
    struct speaker *speaker = user;
    console_capture();
    pthread_barrier_wait(speaker->meeting);
    report_error(&speaker->console->log, "of %s", speaker->name);
    pthread_barrier_wait(speaker->meeting);
    speaker->text = console_captured();
    return NULL;
}

TEST(threads_capture_beside_each_other)
{
    struct console console;
    pthread_barrier_t meeting;
    pthread_t thread;
    struct speaker speakers[2] = {{&console, &meeting, "one", NULL},
                                  {&console, &meeting, "two", NULL}};
    assert_true(console_open(&console));
    assert_int_equal(pthread_barrier_init(&meeting, NULL, 2), 0);
    for (int round = 0; round < 2; round++) {
        assert_int_equal(pthread_create(&thread, NULL, speak, &speakers[1]), 0);
        speak(&speakers[0]);
        pthread_join(thread, NULL);
        for (int i = 0; i < 2; i++) {
            assert_non_null(speakers[i].text);
            assert_string_equal(speakers[i].text, i ? "error: of two\n" : "error: of one\n");
            free(speakers[i].text);
        }
    }
    pthread_barrier_destroy(&meeting);
    console_close(&console);
}

/* ---- Pictures of light ----------------------------------------------------------------------- */

TEST(light_survives_the_round_trip)
{
    struct ear ear = {"", 0};
    const struct dt_log log = {hear, &ear};
    enum { WIDTH = 5, HEIGHT = 3, MOST = 4096 };
    float light[WIDTH * HEIGHT * 3], *rgba;
    uint8_t bytes[2][MOST];
    size_t sizes[2];
    uint32_t width = 0, height = 0;
    char path[] = "/tmp/diptych-XXXXXX.exr";
    close(mkstemps(path, 4));
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
        light[i] = (float)(i * i) * 1.7f - 3;
    for (int round = 0; round < 2; round++) { /* equal files, even a second later */
        usleep(round * 1100000);
        assert_true(hdr_write(path, WIDTH, HEIGHT, light, &log));
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        sizes[round] = fread(bytes[round], 1, MOST, file);
        fclose(file);
    }
    assert_in_range(sizes[0], 1, MOST - 1);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    assert_true(hdr_read(path, &width, &height, &rgba, &log));
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        assert_memory_equal(rgba + 4 * i, light + 3 * i, 3 * sizeof *light);
        assert_float_equal(rgba[4 * i + 3], 1, 0);
    }
    free(rgba);
    assert_int_equal(ear.errors, 0);

    assert_int_equal(truncate(path, (off_t)sizes[0] - 40), 0);
    assert_false(hdr_read(path, &width, &height, &rgba, &log));
    assert_non_null(strstr(ear.last, path));
    assert_int_equal(ear.errors, 1);
    unlink(path);
    assert_false(hdr_write("/tmp/no/such/folder.exr", WIDTH, HEIGHT, light, &log));
    assert_non_null(strstr(ear.last, "/tmp/no/such/folder.exr"));
}

/* Half floats with alpha in a window that does not start at zero, and grey, which OpenImageIO reads. */
TEST(light_of_other_programs_is_read)
{
    struct ear ear = {"", 0};
    const struct dt_log log = {hear, &ear};
    enum { WIDTH = 2, HEIGHT = 2, X = 10, Y = -7 };
    ImfRgba texels[HEIGHT][WIDTH];
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float level = (float)(1 + x + WIDTH * y);
            ImfFloatToHalf(level, &texels[y][x].r);
            ImfFloatToHalf(10 * level, &texels[y][x].g);
            ImfFloatToHalf(100 * level, &texels[y][x].b);
            ImfFloatToHalf(level / 4, &texels[y][x].a);
        }
    for (int grey = 0; grey < 2; grey++) {
        char path[] = "/tmp/diptych-XXXXXX.exr";
        close(mkstemps(path, 4));
        ImfHeader *header = ImfNewHeader();
        ImfHeaderSetDataWindow(header, X, Y, X + WIDTH - 1, Y + HEIGHT - 1);
        ImfHeaderSetDisplayWindow(header, X, Y, X + WIDTH - 1, Y + HEIGHT - 1);
        ImfOutputFile *file = ImfOpenOutputFile(path, header, grey ? IMF_WRITE_Y : IMF_WRITE_RGBA);
        assert_non_null(file);
        assert_true(ImfOutputSetFrameBuffer(file, &texels[0][0] - X - Y * WIDTH, 1, WIDTH));
        assert_true(ImfOutputWritePixels(file, HEIGHT));
        assert_true(ImfCloseOutputFile(file));
        ImfDeleteHeader(header);
        float *rgba;
        uint32_t width, height;
        assert_true(hdr_read(path, &width, &height, &rgba, &log));
        assert_int_equal(width, WIDTH);
        assert_int_equal(height, HEIGHT);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            float level = (float)(1 + i), *texel = rgba + 4 * i;
            /* OpenEXR's luminance of (1, 10, 100) with the weights of Rec. 709 */
            float luminance = 0.2126f + 10 * 0.7152f + 100 * 0.0722f;
            assert_float_equal(texel[0], grey ? luminance * level : level, 0.05);
            assert_float_equal(texel[1], grey ? texel[0] : 10 * level, 0);
            assert_float_equal(texel[2], grey ? texel[0] : 100 * level, 0);
            assert_float_equal(texel[3], grey ? 1 : level / 4, 0);
        }
        free(rgba);
        unlink(path);
    }
    assert_int_equal(ear.errors, 0);
}

RUN_TESTS("app", NULL, NULL)
