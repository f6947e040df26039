/* Findings of the proof in single statements, compiled as they stand: one row for each open
 * operation in the tables of gen/spirv/prove.c. prove_test.sh has the exact operations. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

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
        {"x = mod(x, y);", "mod"},
        {"x = dot(v, v);", "dot"},
        {"v = m * v;", "*"},
        {"v = v * m;", "*"},
        {"m = m * m;", "*"},
        {"mediump int k = i; i = k + 1;", "mediump"},
        {"x = atan(y, x);", "atan"},
        {"x = pow(x, y);", "pow"},
        {"x = determinant(m);", "determinant"},
        {"m = inverse(m);", "inverse"},
        {"x = min(x, y);", "min"},
        {"x = max(x, y);", "max"},
        {"x = clamp(x, y, 1.0);", "clamp"},
        {"x = step(x, y);", "step"},
        {"x = mix(x, y, v.x);", "mix"},
        {"x = smoothstep(x, y, v.x);", "smoothstep"},
        {"x = fma(x, y, v.x);", "fma"},
        {"x = ldexp(x, i);", "ldexp"},
        {"u = packSnorm4x8(v);", "packSnorm4x8"},
        {"u = packUnorm4x8(v);", "packUnorm4x8"},
        {"u = packSnorm2x16(v.xy);", "packSnorm2x16"},
        {"u = packUnorm2x16(v.xy);", "packUnorm2x16"},
        {"u = packHalf2x16(v.xy);", "packHalf2x16"},
        {"v.xy = unpackSnorm2x16(u);", "unpackSnorm2x16"},
        {"v.xy = unpackUnorm2x16(u);", "unpackUnorm2x16"},
        {"v.xy = unpackHalf2x16(u);", "unpackHalf2x16"},
        {"v = unpackSnorm4x8(u);", "unpackSnorm4x8"},
        {"v = unpackUnorm4x8(u);", "unpackUnorm4x8"},
        {"x = length(v);", "length"},
        {"x = distance(v, v.wzyx);", "distance"},
        {"n = cross(n, n.zxy);", "cross"},
        {"v = normalize(v);", "normalize"},
        {"n = faceforward(n, n.zxy, n.yzx);", "faceforward"},
        {"n = reflect(n, n.zxy);", "reflect"},
        {"n = refract(n, n.zxy, x);", "refract"},
        {"v = textureLod(t, v.xy, 0.0);", "texture"},
        {"v = textureProjLod(t, n, 0.0);", "textureProjLod"},
        {"v = textureGather(t, v.xy);", "textureGather"},
        {"atomicAdd(u, 1u);", NULL},
        {"u = atomicAdd(u, 1u);", "atomicAdd"},
        {"if (atomicMin(u, 1u) > 2u) x = 1.0;", "atomicMin"},
        {"i = atomicMax(i, 1);", "atomicMax"},
        {"u = atomicAnd(u, 1u);", "atomicAnd"},
        {"u = atomicOr(u, 1u);", "atomicOr"},
        {"u = atomicXor(u, 1u);", "atomicXor"},
        {"atomicExchange(u, 1u);", "atomicExchange"},
        {"atomicCompSwap(u, 1u, 2u);", "atomicCompSwap"},
        {"x = float(double(y));", "an operation"}, /* OpFConvert, which the proof does not know */
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
      {"o = vec4(gl_SampleID);", "an operation"}, /* an input that the proof does not know */
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

/* Functions of one number, by the text around their name. */
static void prove_functions(const char *shader, enum stage stage, const char *before,
                            const char *behind, const char *const *names)
{
    char text[64];
    for (; *names; names++) {
        snprintf(text, sizeof text, "%s%s%s", before, *names, behind);
        prove(shader, stage, &(struct row){text, *names});
    }
}

static void test_compute(void **state)
{
    static const char *const names[] = {"round", "fract", "radians", "degrees",     "sin",  "cos",
                                        "tan",   "asin",  "acos",    "atan",        "sinh", "cosh",
                                        "tanh",  "asinh", "acosh",   "atanh",       "exp",  "log",
                                        "exp2",  "log2",  "sqrt",    "inversesqrt", NULL};
    (void)state;
    for (size_t i = 0; i < sizeof in_compute / sizeof *in_compute; i++)
        prove(compute, STAGE_IS_COMPUTE, &in_compute[i]);
    prove_functions(compute, STAGE_IS_COMPUTE, "x = ", "(y);", names);
}

static void test_fragment(void **state)
{
    static const char *const names[] = {"dFdx",         "dFdy",       "fwidth",     "dFdxFine",
                                        "dFdyFine",     "fwidthFine", "dFdxCoarse", "dFdyCoarse",
                                        "fwidthCoarse", NULL};
    (void)state;
    for (size_t i = 0; i < sizeof in_fragment / sizeof *in_fragment; i++)
        prove(fragment, STAGE_IS_FRAGMENT, &in_fragment[i]);
    prove_functions(fragment, STAGE_IS_FRAGMENT, "o = ", "(f);", names);
}

static void take_library(void *user, const struct open_operation *operation)
{
    (void)user;
    fail_msg("the library: found `%s`, %s", operation->word, operation->why);
}

/* All functions of the library of exact passes as they join a shader, also those that no shader of ours calls. */
static void test_library(void **state)
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
    assert_true(spirv_link_begin(&link, &edit));
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
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_compute),
        cmocka_unit_test(test_fragment),
        cmocka_unit_test(test_library),
    };
    glslang_start();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
