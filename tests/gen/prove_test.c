/* Findings of the proof in single statements, compiled as they stand: one row for each open
 * operation in the tables of gen/spirv/prove.c. prove_test.sh has the exact operations. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

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
        {"x = round(y);", "round"},
        {"x = fract(y);", "fract"},
        {"x = radians(y);", "radians"},
        {"x = degrees(y);", "degrees"},
        {"x = sin(y);", "sin"},
        {"x = cos(y);", "cos"},
        {"x = tan(y);", "tan"},
        {"x = asin(y);", "asin"},
        {"x = acos(y);", "acos"},
        {"x = atan(y);", "atan"},
        {"x = atan(y, x);", "atan"},
        {"x = sinh(y);", "sinh"},
        {"x = cosh(y);", "cosh"},
        {"x = tanh(y);", "tanh"},
        {"x = asinh(y);", "asinh"},
        {"x = acosh(y);", "acosh"},
        {"x = atanh(y);", "atanh"},
        {"x = pow(x, y);", "pow"},
        {"x = exp(y);", "exp"},
        {"x = log(y);", "log"},
        {"x = exp2(y);", "exp2"},
        {"x = log2(y);", "log2"},
        {"x = sqrt(y);", "sqrt"},
        {"x = inversesqrt(y);", "inversesqrt"},
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
      {"o = dFdx(f);", "dFdx"},
      {"o = dFdy(f);", "dFdy"},
      {"o = fwidth(f);", "fwidth"},
      {"o = dFdxFine(f);", "dFdxFine"},
      {"o = dFdyFine(f);", "dFdyFine"},
      {"o = fwidthFine(f);", "fwidthFine"},
      {"o = dFdxCoarse(f);", "dFdxCoarse"},
      {"o = dFdyCoarse(f);", "dFdyCoarse"},
      {"o = fwidthCoarse(f);", "fwidthCoarse"},
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

/* Findings go to `found`. */
static void prove_code(const char *code, glslang_stage_t stage, const char *name,
                       void (*found)(void *, const struct open_operation *), void *user)
{
    const glslang_input_t input = {.language = GLSLANG_SOURCE_GLSL,
                                   .stage = stage,
                                   .client = GLSLANG_CLIENT_VULKAN,
                                   .client_version = GLSLANG_TARGET_VULKAN_1_3,
                                   .target_language = GLSLANG_TARGET_SPV,
                                   .target_language_version = GLSLANG_TARGET_SPV_1_5,
                                   .code = code,
                                   .default_version = 460,
                                   .default_profile = GLSLANG_CORE_PROFILE,
                                   .messages = GLSLANG_MSG_SPV_RULES_BIT |
                                               GLSLANG_MSG_VULKAN_RULES_BIT |
                                               GLSLANG_MSG_KEEP_UNCALLED_BIT,
                                   .resource = glslang_default_resource()};
    glslang_shader_t *compiled = glslang_shader_create(&input);
    glslang_program_t *program = glslang_program_create();
    if (!glslang_shader_preprocess(compiled, &input) || !glslang_shader_parse(compiled, &input))
        fail_msg("%s: %s", name, glslang_shader_get_info_log(compiled));
    glslang_program_add_shader(program, compiled);
    assert_true(glslang_program_link(program, input.messages));
    glslang_program_SPIRV_generate(program, stage);
    const uint32_t *words = glslang_program_SPIRV_get_ptr(program);
    size_t size = glslang_program_SPIRV_get_size(program);
    struct spirv module;
    assert_true(spirv_open(&module, words, size));
    assert_true(prove_module(&module, found, user));
    spirv_free(&module);
    glslang_program_delete(program);
    glslang_shader_delete(compiled);
}

static void prove(const char *shader, glslang_stage_t stage, const struct row *row)
{
    char code[1024];
    unsigned found = 0;
    snprintf(code, sizeof code, shader, row->statement);
    prove_code(code, stage, row->statement, take, (void *)row);
    prove_code(code, stage, row->statement, count, &found);
    if (!found != !row->word)
        fail_msg("%s: found nothing", row->statement);
}

static void test_compute(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof in_compute / sizeof *in_compute; i++)
        prove(compute, GLSLANG_STAGE_COMPUTE, &in_compute[i]);
}

static void test_fragment(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof in_fragment / sizeof *in_fragment; i++)
        prove(fragment, GLSLANG_STAGE_FRAGMENT, &in_fragment[i]);
}

/* Sums and products are marked where the functions join a shader; min and max become NMin and NMax there. */
static void take_library(void *user, const struct open_operation *operation)
{
    (void)user;
    if (strcmp(operation->why, "it may be contracted with other operations") != 0 &&
        strcmp(operation->word, "min") != 0 && strcmp(operation->word, "max") != 0)
        fail_msg("the library: found `%s`, %s", operation->word, operation->why);
}

/* All functions of the library of exact passes, also those that no shader of ours calls. */
static void test_library(void **state)
{
    (void)state;
    static char code[1 << 17];
    size_t size = 0;
    static const char *const paths[] = {"templates/glsl/exact.glsl", "templates/glsl/values.glsl"};
    for (int i = 0; i < 2; i++) {
        FILE *file = fopen(paths[i], "r");
        assert_non_null(file);
        size += fread(code + size, 1, sizeof code - size - 1, file);
        fclose(file);
    }
    prove_code(code, GLSLANG_STAGE_COMPUTE, "the library", take_library, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_compute),
        cmocka_unit_test(test_fragment),
        cmocka_unit_test(test_library),
    };
    glslang_initialize_process();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
