/* Findings of the proof in single statements, compiled as they stand: one row for each open
 * operation in the tables of gen/spirv/prove.c. prove_test.sh has the exact operations. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/lib/unit.h"
#include "base/files.h"
#include "glsl/glslang.h"
#include "glsl/shader.h"
#include "spirv/link.h"
#include "spirv/prove.h"

static const char compute[] = "#version 460\n"
                              "layout(local_size_x = 1) in;\n"
                              "layout(std430, binding = 0) buffer B {\n"
                              "    vec4 v; vec3 n; float x, y; mat4 m; uint u; int i;\n"
                              "};\n"
                              "layout(binding = 1) uniform sampler2D t;\n"
                              "void main() { %s }\n";
static const char fragment[] = "#version 460\n"
                               "layout(location = 0) out vec4 o;\n"
                               "layout(location = 0) in vec4 s;\n"
                               "layout(location = 1) flat in vec4 f;\n"
                               "layout(binding = 1) uniform sampler2D t;\n"
                               "layout(binding = 2) uniform sampler2DShadow d;\n"
                               "void main() { %s }\n";

static const struct row {
    const char *statement;
    const char *word; /* the finding, once or more; NULL: none */
} in_compute[] =
    {
        {"x = x + y;", "+"},
        {"x = x - y;", "-"},
        {"x = x * y;", "*"},
        {"v = v * x;", "*"},
        {"m = m * x;", "*"},
        {"m = outerProduct(v, v);", "outerProduct"},
        {"precise float sum = x * y + x; x = sum;", NULL},
        {"x = x / y;", "/"},
        {"v = m * v;", "*"},
        {"v = v * m;", "*"},
        {"m = m * m;", "*"},
        {"mediump int k = i; i = k + 1;", "mediump"},
        {"x = determinant(m);", "determinant"},
        {"m = inverse(m);", "inverse"},
        {"x = ldexp(x, i);", "ldexp"},
        {"x = length(v);", "length"},
        {"v = normalize(v);", "normalize"},
        {"n = faceforward(n, n.zxy, n.yzx);", "faceforward"},
        {"n = refract(n, n.zxy, x);", "refract"},
        {"v = textureLod(t, v.xy, 0.0);", "texture"},
        {"v = textureProjLod(t, n, 0.0);", "textureProjLod"},
        {"v = textureGather(t, v.xy);", "textureGather"},
        {"atomicAdd(u, 1u);", NULL},
        {"if (atomicMin(u, 1u) > 2u) x = 1.0;", "atomicMin"},
        {"i = atomicMax(i, 1);", "atomicMax"},
        {"atomicExchange(u, 1u);", "atomicExchange"},
        {"atomicCompSwap(u, 1u, 2u);", "atomicCompSwap"},
        {"x = float(double(y));", "FConvert"}, /* OpFConvert, which the proof does not know */
},
  in_fragment[] = {
      {"o = f;", NULL},
      {"o = s;", "s"},
      {"o = vec4(s.y);", "s"},
      {"o = gl_FragCoord.xyxy;", NULL},
      {"o = vec4(gl_FragCoord.y);", NULL},
      {"o = gl_FragCoord;", "gl_FragCoord"},
      {"o = vec4(gl_FragCoord.z);", "gl_FragCoord"},
      {"o = gl_FragCoord.xyzy;", "gl_FragCoord"},
      {"o = vec4(gl_FrontFacing);", NULL},
      {"o = gl_PointCoord.xyxy;", "gl_PointCoord"},
      {"o = vec4(gl_HelperInvocation);", "gl_HelperInvocation"},
      {"o = vec4(gl_SampleID);", "gl_SampleID"}, /* an input that the proof does not know */
      {"o = texture(t, f.xy);", "texture"},
      {"o = vec4(texture(d, f.xyz));", "texture"},
      {"o = vec4(textureLod(d, f.xyz, 0.0));", "texture"},
      {"o = textureProj(t, f.xyz);", "textureProj"},
      {"o = textureGather(d, f.xy, 0.5);", "textureGather"},
      {"o = textureQueryLod(t, f.xy).xyxy;", "textureQueryLod"},
      {"o = interpolateAtCentroid(s);", "interpolateAtCentroid"},
      {"o = interpolateAtSample(s, 1);", "interpolateAtSample"},
      {"o = interpolateAtOffset(s, f.xy);", "interpolateAtOffset"},
};

static void take(void *user, const struct open_operation *operation)
{
    const struct row *row = user;
    if (!row->word || strcmp(row->word, operation->word) != 0)
        fail_msg("%s: found `%s`, %s", row->statement, operation->word, operation->why);
}

static void count(void *user, const struct open_operation *operation)
{
    (void)operation;
    ++*(unsigned *)user;
}

static struct spirv compile(const char *code, enum stage stage)
{
    const struct glslang_job job = {.code = code, .stage = (int)stage, .minor = 5};
    struct spirv module;
    size_t length;
    char *log = NULL;
    uint32_t *words = glslang_compile(&job, &length, &log);
    if (!words)
        fail_msg("%s: %s", code, log);
    assert_true(spirv_read(&module, words, length));
    return module;
}

static void prove(const char *shader, enum stage stage, const struct row *row)
{
    char code[1024];
    unsigned found = 0;
    snprintf(code, sizeof code, shader, row->statement);
    struct spirv module = compile(code, stage);
    assert_true(prove_module(&module, take, (void *)row));
    assert_true(prove_module(&module, count, &found));
    spirv_free(&module);
    if (!found != !row->word)
        fail_msg("%s: found nothing", row->statement);
}

/* Functions with the same arguments: the text around each name. */
static const struct functions {
    const char *before, *behind, *names[24];
} functions[] =
    {
        {"x = ", "(y);", {"round", "fract", "radians", "degrees",    "sin",  "cos",
                          "tan",   "asin",  "acos",    "atan",       "sinh", "cosh",
                          "tanh",  "asinh", "acosh",   "atanh",      "exp",  "log",
                          "exp2",  "log2",  "sqrt",    "inversesqrt"}},
        {"x = ", "(x, y);", {"mod", "pow", "min", "max", "step", "atan"}},
        {"x = ", "(x, y, v.x);", {"clamp", "mix", "smoothstep", "fma"}},
        {"x = ", "(v, v.wzyx);", {"dot", "distance"}},
        {"n = ", "(n, n.zxy);", {"cross", "reflect"}},
        {"u = ", "(v.xy);", {"packSnorm2x16", "packUnorm2x16", "packHalf2x16"}},
        {"u = ", "(v);", {"packSnorm4x8", "packUnorm4x8"}},
        {"v.xy = ", "(u);", {"unpackSnorm2x16", "unpackUnorm2x16", "unpackHalf2x16"}},
        {"v = ", "(u);", {"unpackSnorm4x8", "unpackUnorm4x8"}},
        {"u = ", "(u, 1u);", {"atomicAdd", "atomicAnd", "atomicOr", "atomicXor"}},
},
  fragment_functions = {"o = ",
                        "(f);",
                        {"dFdx", "dFdy", "fwidth", "dFdxFine", "dFdyFine", "fwidthFine",
                         "dFdxCoarse", "dFdyCoarse", "fwidthCoarse"}};

static void prove_functions(const char *shader, enum stage stage, const struct functions *of)
{
    char text[64];
    for (int i = 0; of->names[i]; i++) {
        snprintf(text, sizeof text, "%s%s%s", of->before, of->names[i], of->behind);
        prove(shader, stage, &(struct row){text, of->names[i]});
    }
}

TEST(test_compute)
{
    for (size_t i = 0; i < sizeof in_compute / sizeof *in_compute; i++)
        prove(compute, STAGE_IS_COMPUTE, &in_compute[i]);
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
        prove_functions(compute, STAGE_IS_COMPUTE, &functions[i]);
}

TEST(test_fragment)
{
    for (size_t i = 0; i < sizeof in_fragment / sizeof *in_fragment; i++)
        prove(fragment, STAGE_IS_FRAGMENT, &in_fragment[i]);
    prove_functions(fragment, STAGE_IS_FRAGMENT, &fragment_functions);
}

static void take_library(void *user, const struct open_operation *operation)
{
    (void)user;
    fail_msg("the library: found `%s`, %s", operation->word, operation->why);
}

/* All functions of the library of exact passes as they join a shader, also those that no shader of ours calls. */
TEST(test_library)
{
    static const char *const paths[] = {"templates/glsl/exact.glsl", "templates/glsl/values.glsl"};
    struct text text = {0};
    struct spirv_edit edit = {0};
    struct spirv_link link;
    (void)state;
    for (int i = 0; i < 2; i++) {
        size_t size;
        char *part = file_read(paths[i], &size, NULL);
        text_add_bytes(&text, part, size);
        free(part);
    }
    struct spirv library = compile(text.data, STAGE_IS_COMPUTE);
    struct spirv module = compile("#version 460\nvoid main() {}\n", STAGE_IS_COMPUTE);
    spirv_edit_begin(&edit, &module);
    spirv_edit_keep(&edit);
    spirv_link_begin(&link, &edit);
    for (uint32_t i = 0; i < library.function_count; i++)
        spirv_link_function(&link, spirv_name(&library, library.functions[i].id));
    spirv_link_end(&link);
    assert_true(spirv_edit_end(&edit, &module));
    assert_int_equal(module.function_count, library.function_count + 1); /* two are main() */
    assert_true(prove_module(&module, take_library, NULL));
    spirv_free(&module);
    spirv_free(&library);
    text_free(&text);
}

int main(void)
{
    glslang_start(false);
    return unit_run("prove", NULL, NULL);
}
