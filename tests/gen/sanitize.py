#!/usr/bin/env python3
"""For sanitize_test.sh: `make FOLDER [SEED]` writes wrong.yaml, wrong_memory.yaml and wrong_draw.yaml, whose bodies are undefined in the
line that ends with `// here`, and fine.yaml, whose bodies come near but are not; some_NAME.yaml has a sixth of the bodies of NAME.yaml,
few.yaml two. `found FILE.json SPEC` checks the findings of a wrong spec against the messages below, `silent FILE.json SPEC` those of a
fine one, `equal DUMP DUMP` that two dumps have the same bits."""
import json
import os
import random
import re
import sys

HEAD = """pipeline: {name}
params:
  zero: {{value: 0.0, live: true}}
  one: {{value: 1.0, live: true}}
buffers:
  taps: {{of: float, count: 8}}
  cells: {{of: Cell, count: 4}}
  sparse: {{of: float, count: 64}}
  steps: {{of: uint, count: 64}}
  vectors: {{of: vec4, count: 64}}
  partial: {{of: Cell, count: 4}}
{buffers}samplers:
  soft: {{kind: filter, filter: linear, mip_filter: linear}}
structs:
  Cell: {{weight: float, parts: {{type: float, count: 4}}}}
images:
  grid: {{format: rgba32f, size: [8, 4]}}
  pyramid: {{format: rgba32f, size: [8, 8], mips: 2}}
  faces: {{format: r32f, size: [4, 4], cube: true}}
{images}  patchy: {{format: rgba16f, size: [8, 8]}}
  stack: {{format: r32ui, size: [4, 4], layers: 2}}
passes:
  - {{name: fill, dispatch: 8, writes: [taps], shader: fill.glsl}}
  - {{name: cells, dispatch: 4, writes: [cells], shader: cells.glsl}}
  - {{name: paint, dispatch: grid, writes: [grid], shader: paint.glsl}}
  - {{name: fine_mip, dispatch: [8, 8], writes: [{{name: pyramid, mip: 0, as: mip}}], shader: mip.glsl}}
  - {{name: coarse_mip, dispatch: [4, 4, 6], local: [4, 4, 6], writes: [{{name: pyramid, mip: 1, as: mip}}, faces], shader: mips.glsl}}
  - {{name: stack, dispatch: stack, writes: [stack], shader: stack.glsl}}
  - {{name: some, dispatch: 64, writes: [sparse, steps, vectors, partial], shader: some.glsl}}
  - {{name: patching, dispatch: patchy, writes: [patchy], shader: patching.glsl}}
{passes}"""
PASS = ("  - {{name: {0}, dispatch: 64, local: 32, reads: [taps, cells, grid, sparse, steps, vectors, partial, patchy, faces, {{name: pyramid, sampler: soft}}], updates: [stack], "
        "writes: [{{name: out_{0}, as: result}}], shader: {0}.glsl}}\n")
DRAW = "  - {{name: {0}, draw: fullscreen, reads: [{{name: pyramid, sampler: soft}}], writes: [{{name: out_{0}, as: result}}], shader: {0}.glsl}}\n"
FILES = {
    "mip": "void main() { mip_store(invocation().xy, vec4(1)); }\n",
    "mips": "void main() { ivec3 p = invocation(); faces_store(p, vec4(1)); if (p.z == 0) mip_store(p.xy, vec4(1)); }\n",
    "fill": "void main() { int i = invocation().x; if (i < 8) taps[i] = float(i + 1); }\n",
    "cells": "void main() { int i = invocation().x;\n"
             "    if (i < 4) cells[i] = Cell(1.0, float[4](1.0, 2.0, 3.0, 4.0)); }\n",
    "paint": "void main() { ivec2 p = invocation().xy; if (all(lessThan(p, grid_size()))) grid_store(p, vec4(p, 1, 1)); }\n",
    "some": "void main() { int i = invocation().x;\n"
            "    if (i % 2 == 0) { sparse[i] = 1.0; steps[i] = 2u; }\n"
            "    vectors[i].xy = vec2(i);\n    if (i < 4) partial[i].weight = 1.0; }\n",
    "patching": "void main() { ivec2 p = invocation().xy; if (p.x % 2 == 0) patchy_store(p, vec4(1)); }\n",
    "stack": "void main() { ivec3 p = invocation(); if (p.x < 4 && p.y < 4) stack_store(p, uvec4(p.z)); }\n",
}
START = "    int i = invocation().x, l = i % 32; /* 0 to 63, and 0 to 31 in each workgroup */\n    int null = int(zero); float x = float(i);\n"


DRAW_START = "    ivec2 p = ivec2(gl_FragCoord.xy); float x = gl_FragCoord.x, r = 0.0; /* 16 x 16 */\n    vec2 uv = gl_FragCoord.xy / 16.0; float nought = zero;\n"


def draw_body(code, functions=""):
    return f"{functions}void main() {{\n{DRAW_START}    {code}\n    result = vec4(r);\n}}\n"


def body(code, functions=""):
    return f"{functions}void main() {{\n{START}    float r = 0.0;\n    {code}\n    result[i] = r;\n}}\n"


NAN = "float nan = uintBitsToFloat(0x7fc00000u);\n"
# What the line says, the column that it names (the text from there on), the message, the least invocation.
WRONG = [
    # indices
    ("r = taps[i / 4];", "taps", "index 8 of `taps`, which has 8 elements", 32),
    ("float a[5] = float[5](x, 1.0, 2.0, 3.0, 4.0); r = a[i % 7];", "a[i %", "index 5 of `a`, which has 5 elements", 5),
    ("vec3 v = vec3(x); r = v[i / 16];", "v[i", "index 3 of `v`, which has 3 elements", 48),
    ("mat2 m = mat2(x); r = m[i - 1].x;", "m[i", "index -1 of `m`, which has 2 elements", 0),
    ("r = cells[i % 4].parts[i / 8];", "parts", "index 4 of `parts`, which has 4 elements", 32),
    ("r = cells[i / 8].weight;", "cells", "index 4 of `cells`, which has 4 elements", 32),
    ("r = grid(ivec2(i, 0)).x;", "grid", "texel (8, 0) of `grid`, which has 8 x 4 texels", 8),
    ("r = grid(ivec2(0, 3 - i)).x;", "grid", "texel (0, -1) of `grid`, which has 8 x 4 texels", 4),
    ("if (l == 0) stack_store(ivec3(0, 0, i / 32 + 1), uvec4(1)); r = 1.0;", "stack_store",
     "texel (0, 0, 2) of `stack`, which has 4 x 4 texels", 32),
    ("if (i % 8 == 0) scratch[i / 8] = x; r = 1.0;", "scratch", "index 4 of `scratch`, which has 4 elements", 32, "shared float scratch[4];\n"),
    ("scratch[i * 9999] = x; r = x;", "scratch", "index 9999 of `scratch`, which has 4 elements", 1,
     "shared float scratch[4];\n"),
    ("r = texelFetch(pyramid_texture, ivec2(0), i / 16).x;", "pyramid_texture", "mip 2 of `pyramid`, which has 2 mips", 32),
    ("r = texelFetch(pyramid_texture, ivec2(i % 6, 0), 1).x;", "pyramid_texture", "texel (4, 0) of `pyramid`, which has 4 x 4 texels", 4),
    ("r = faces(ivec3(0, 0, i / 10)).x;", "faces", "texel (0, 0, 6) of `faces`, which has 4 x 4 texels", 60),
    ("r = table[i / 8];", "[i", "index 7 of an array of 7 elements", 56, "const float table[7] = float[](1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);\n"),
    # arithmetic of integers
    ("r = float(7 / (i - 3));", "/ (", "7 / 0", 3),
    ("int least = null - 2147483647 - 1; r = float(least / (i - 5));", "/ (i", "-2147483648 / -1", 4),
    ("r = float((i - 3) % 5);", "% 5", "-3 % 5", 0),
    ("r = float(7u % uint(i - 2));", "% uint", "7 % 0", 2),
    ("r = float(1 << i);", "<< i", "a shift by 32 of 32 bits", 32),
    ("r = float(-8 >> i - 1);", ">> i", "a shift by -1 of 32 bits", 0),
    ("r = float(bitfieldExtract(i, i, 8));", "bitfieldExtract", "8 bits from bit 25 of 32", 25),
    ("r = float(clamp(i, i, 50));", "clamp", "clamp from 51 to 50", 51),
    ("r = float(7u / uint(i));", "/ uint", "7 / 0", 0),
    ("int k = 7; k %= i - 2; r = float(k);", "%= i", "7 % -2", 0),
    ("ivec2 q = ivec2(7) / ivec2(1, i - 9); r = float(q.y);", "/ ivec2", "7 / 0", 9),
    ("r = float(bitfieldInsert(i, 3, i, 8));", "bitfieldInsert", "8 bits from bit 25 of 32", 25),
    # arithmetic of floats
    ("r = float(int(x * 1e8));", "int(x", "2.20000000e+09 as an int", 22),
    ("r = float(uint(x - 1.0));", "uint(", "-1 as a uint", 0),
    ("r = 1.0 / (x - 4.0);", "/ (", "`/` of finite numbers makes inf", 4),
    ("r = (x * 1e36) * 1e1;", "* 1e1", "`*` of finite numbers makes inf", 35),
    ("r = exp(x * 3.0);", "exp", "`exp` of finite numbers makes inf", 30),
    ("r = sqrt(3.0 - x);", "sqrt", "sqrt(-1)", 4),
    ("r = log(x);", "log", "log(0)", 0),
    ("r = pow(x - 2.0, 0.5);", "pow", "pow(-2, 0.5)", 0),
    ("r = asin(x / 32.0);", "asin", "asin(1.03125)", 33),
    ("r = acos(x / 32.0);", "acos", "acos(1.03125)", 33),
    ("r = atanh(x / 32.0);", "atanh", "atanh(1)", 32),
    ("r = inversesqrt(x);", "inversesqrt", "inversesqrt(0)", 0),
    ("r = pow(x, zero - 1.0);", "pow", "pow(0, -1)", 0),
    ("r = mix(x, uintBitsToFloat(0x7fc00000u), 0.5);", "mix", "mix of a NaN", 0),
    ("r = ldexp(1.0, i * 4);", "ldexp", "`ldexp` of finite numbers makes inf", 32),
    ("r = inverse(mat2(x, x, x, x))[0].x;", "inverse", "`inverse` of finite numbers makes", 0),
    ("r = float(int(uintBitsToFloat(0x7fc00000u + uint(i))));", "int(uint", "nan as an int", 0),
    ("r = atan(x, x);", "atan", "atan(0, 0)", 0),
    ("r = normalize(vec3(x, 0.0, zero)).y;", "normalize", "normalize of zero", 0),
    ("r = smoothstep(x, 32.0, 5.0);", "smoothstep", "smoothstep from 32 to 32", 32),
    ("r = faceforward(vec2(1.0), vec2(x * 1e36), vec2(x)).x;", "faceforward", "`faceforward` of finite numbers makes inf on its way", 14),
    ("r = normalize(vec2(x * 1e18 + 1.0)).x;", "normalize", "`normalize` of finite numbers makes inf on its way", 14),
    ("r = smoothstep(x * -5e36, x * 5e36 + 1.0, 5.0);", "smoothstep", "`smoothstep` of finite numbers makes inf on its way", 35),
    ("r = clamp(5.0, x, 32.0);", "clamp", "clamp from 33 to 32", 33),
    ("r = mat2(x * 1e36, 1.0, 1.0, 1.0)[0].x * one; r = dot(vec2(r), vec2(r));", "dot", "`dot` of finite numbers makes inf", 1),
    ("uint k = uint(1.0 - x); r = float(k);", "uint(", "-1 as a uint", 2),
    ("r = degrees(x * 1e36);", "degrees", "`degrees` of finite numbers makes inf", 6),
    ("r = max(x + nan, 0.0);", "max", "nan goes into `max`, which drops it", 0, NAN),
    ("r = min(vec2(x, i < 7 ? x : nan), 1.0).y;", "min", "nan goes into `min`, which drops it", 7, NAN),
    ("r = clamp(i < 9 ? x : nan, 0.0, 1.0);", "clamp", "nan goes into `clamp`, which drops it", 9, NAN),
    ("r = unpackHalf2x16(packHalf2x16(vec2(1.0, x * 2e3))).y;", "packHalf2x16", "packHalf2x16 makes infinity of 66000", 33),
    ("r = unpackUnorm4x8(packUnorm4x8(vec4(i < 9 ? x : nan))).x;", "packUnorm4x8", "packUnorm4x8 of a NaN", 9, NAN),
    ("int e; r = frexp(i < 4 ? x : uintBitsToFloat(0x7f800000u), e) + float(e);", "frexp", "frexp(inf", 4),
    # what ends a CPU's driver
    ("int least = null - 2147483647 - 1; r = float(least / -(i + 1));", "/ -(", "-2147483648 / -1", 0),
    ("ivec2 k = ivec2(1, i - 5), n = ivec2(null - 2147483647 - 1); r = float((n % k).y);", "% k", "-2147483648 % 1", 0),
    # loops
    ("for (int k = 0; k >= 0; k += null) if (i != 5) break;", "for", "loops of more than 65,000 turns", 5),
    ("while (true) if (i < 63) break;", "while", "loops of more than 65,000 turns", 63),
    ("int k = 0; do { k += null; r += 1.0; } while (k < i - 62);", "do", "loops of more than 65,000 turns", 63),
    ("for (;;) { if (x < 60.0) break; r += one; }", "for", "loops of more than 65,000 turns", 60),
    ("for (int k = 0; k < 300; k++) for (int n = 0; n < 300 * int(i == 9); n++) r += one;", "for (int n",
     "loops of more than 65,000 turns", 9),
    ("uint k = 1u; while (k != 0u) { k += uint(i / 32); if (i < 32) break; }", "while", "loops of more than 65,000 turns", 32),
    # variables
    ("float u; if (i > 3) u = x; r = u;", "u;", "`u` is read before it has a value", 0, "", 2),
    ("vec3 u; u.xy = vec2(x); r = u.x + u.z;", "u.z", "`u` is read before it has a value", 0),
    ("float u; f(u);\n    r = u;", "u;", "`u` is read before it has a value", 0, "void f(out float o) { if (invocation().x > 63) o = 1.0; }\n"),
    ("r = f(x);", "o -=", "`o` is read before it has a value", 0, "float f(float v) { float o;\n    o -= v; // here\n    return o; }\n"),
    ("Cell c, d; d = c; // here\n    r = d.weight;", "c; //", "`c` is read before it has a value", 0),
    ("int n; for (int k = 0; k < 3; k++) n += k; r = float(n);", "n +=", "`n` is read before it has a value", 0),
    ("r = g;", "g;", "`g` is read before it has a value", 0, "float g;\n"),
    ("Cell c; c.parts[0] = x; r = c.weight;", "c.weight", "`c` is read before it has a value", 0),
    ("float a[4]; a[0] = x; r = a[1];", "a[1]", "`a` is read before it has a value", 0),
    ("mat2 m; m[0] = vec2(x); r = (m * vec2(x)).x;", "m *", "`m` is read before it has a value", 0),
    ("float a[4]; r = a[i % 4];", "a[i", "`a` is read before it has a value", 0),
    ("float a[4]; a[i % 4] = x; r = a[(i + 1) % 4];", "a[(i", "`a` is read before it has a value", 0),
    ("vec2 v; v[i & 1] = x; r = v.x;", "v.x", "`v` is read before it has a value", 1),
    ("Cell c; for (int k = 0; k < 3; k++) c.parts[k] = x; r = c.parts[3];", "c.parts[3]", "`c` is read before it has a value", 0),
    ("float a[2][2]; a[0][0] = x; r = a[0][1];", "a[0][1]", "`a` is read before it has a value", 0),
    ("float u; bool b = i > 3; if (b) u = x; if (b || u > 5.0) r = 1.0;", "u >", "`u` is read before it has a value", 0),
]
WRONG_MEMORY = [
    # content
    ("r = sparse[i];", "sparse", "element 1 of `sparse` was never written in this frame", 1),
    ("r = sparse[2] + sparse[i | 1];", "sparse[i", "element 1 of `sparse` was never written in this frame", 0),
    ("r = patchy(ivec2(i % 8, i / 8)).x;", "patchy", "texel (1, 0) of `patchy` was never written in this frame", 1),
    ("if (vectors[i].z > 0.5) r = 1.0;", "vectors", "element 0 of `vectors` was never written in this frame", 0),
    ("Cell c = partial[i % 4]; r = c.parts[1];", "partial", "element 0 of `partial` was never written in this frame", 0),
    ("r = taps[steps[i] & 7u];", "steps", "element 1 of `steps` was never written in this frame", 1),
    ("r = f(i);", "sparse", "element 1 of `sparse` was never written in this frame", 1,
     "float f(int k) { float v = sparse[k]; // here\n    return k > 0 ? v : 2.0; }\n"),
    ("if (l > 3) scratch[l] = x; barrier(); r = scratch[l];", "scratch", "element 0 of `scratch` was never written", 0,
     "shared float scratch[32];\n", 2),
    ("float v = sparse[i], w; r = modf(v, w); if (w > 3.0) r = 1.0;", "sparse", "element 1 of `sparse` was never written in this frame", 1),
    ("float v = sparse[i]; bool even = i % 2 == 0; if (even || v > 0.5) r = 1.0;", "sparse", "element 1 of `sparse` was never written in this frame", 1),
    # races
    ("scratch[l] = 0.0; barrier(); scratch[l] = x; r = scratch[l ^ 1];", "scratch",
     "element 1 of `scratch` is also touched by invocation (1, 0, 0), and no barrier is between", 0, "shared float scratch[32];\n", 2),
    ("scratch[l] = x; barrier(); for (int k = 16; k > 0; k /= 2) if (l < k) scratch[l] += scratch[l + k];", "scratch",
     "element 1 of `scratch` is also touched by invocation (1, 0, 0), and no barrier is between", 0, "shared float scratch[32];\n", 2),
    ("stack_store(ivec3(1), uvec4(i));", "stack_store", "texel (1, 1, 1) of `stack` is also touched by invocation (1, 0, 0)", 0),
    ("cell.weight = 1.0; r = 1.0;", "cell", "`cell` is also touched by invocation (1, 0, 0)", 0, "shared Cell cell;\n"),
    ("if (l == 7) stack_store(ivec3(1), uvec4(i));", "stack_store", "texel (1, 1, 1) of `stack` is also touched by invocation (39, 0, 0)", 7),
    ("if (i == 7) stack_store(ivec3(3, 2, 1), uvec4(i)); barrier(); if (i == 39) stack_store(ivec3(3, 2, 1), uvec4(i));", "stack_store",
     "texel (3, 2, 1) of `stack` is also touched by invocation (39, 0, 0)", 7, "", 2),
    ("stack_atomicAdd(ivec3(2, 0, 0), 1u); if (i == 40) stack_store(ivec3(2, 0, 0), uvec4(0));", "stack_store",
     "texel (2, 0, 0) of `stack` is also touched by invocation (40, 0, 0)", 0),
    ("modf(x, result[0]); r = 1.0;", "result", "element 0 of `out_", 0),
    ("result[i / 2] = x;", "result", "element 0 of `out_", 0),
    # control flow
    ("if (l < 10) barrier();", "barrier", "some invocations of the workgroup do not reach this barrier", 10),
    ("for (int k = 0; k < 1 + l / 16; k++) barrier();", "barrier", "some invocations of the workgroup do not reach this barrier", 0),
    ("if (l < 16) barrier(); else barrier();", "barrier", "some invocations of the workgroup do not reach this barrier", 16, "", 2),
    ("if (l > 20) return; barrier();", "barrier", "some invocations of the workgroup do not reach this barrier", 21),
    ("switch (l / 16) { case 0: barrier(); break; default: break; }", "barrier",
     "some invocations of the workgroup do not reach this barrier", 16),
    ("for (int k = 0; k < 2; k++) if (k == l / 16) barrier();", "barrier", "some invocations of the workgroup do not reach this barrier", 16),
    ("if (l < 16) f(); else f();", "barrier", "some invocations of the workgroup do not reach this barrier", 16,
     "void f() {\n    barrier(); // here\n}\n"),
    ("f(l);", "barrier", "some invocations of the workgroup do not reach this barrier", 5,
     "void f(int k) {\n    if (k < 5) barrier(); // here\n}\n"),
]
PARTED = "some invocations of the quad do not reach this derivative"
WRONG_DRAW = [
    ("if (p.x < 5) r = dFdx(x * x);", "dFdx", PARTED, 4),
    ("for (int k = 0; k < 3; k++) if (k == p.x % 2) r += fwidth(x);", "fwidth", PARTED, 0),
    ("if (p.x % 4 == 1) discard; r = dFdxFine(x);", "dFdxFine", PARTED, 0),
    ("if (p.x < 5) { result = vec4(x); return; } r = dFdy(x);", "dFdy", PARTED, 5),
    ("if (p.y == 7) f(); else f();", "dFdyCoarse", PARTED, 0, "float f() {\n    return dFdyCoarse(gl_FragCoord.x); // here\n}\n"),
    ("for (int k = 0; k < 3; k++) { if (k > p.x) break; r += dFdx(x * float(k)); }", "dFdx", PARTED, 0),
    ("if (p.x == 3) r = texture(pyramid_texture, uv).x;", "texture", PARTED, 3),
    ("r = p.x == 3 ? dFdx(x) : 0.0;", "dFdx", PARTED, 3),
    ("if (p.x == 3) r = pyramid_sample(uv).x;", "pyramid_sample", PARTED, 3),
    ("r = sqrt(4.0 - x);", "sqrt", "sqrt(-0.5)", 4),
    ("if (p.x != 3) result = vec4(x); return;", "result", "`result` is not written", 3),
    ("result = vec4(x); if (p.x != 3) gl_SampleMask[0] = 1; return;", "gl_SampleMask", "`gl_SampleMask` is not written", 3),
    ("result.rg = vec2(x); if (p.y > 2) return;", "result", "`result` is not written", 0),
]
FINE_DRAW = [
    "result = vec4(x); if (p.x == 3) return;", "result.rgb = vec3(x); result.a = r; if (p.x == 3) discard; else return;",
    "r = dFdx(x * x); if (p.x < 4) r += dFdy(x);", "if (p.x / 2 == 3) for (int k = 0; k < 3; k++) r += dFdx(x * float(k));",
    "r = dFdx(x); if (p.x % 4 == 1) discard;", "if (x < 0.0) discard; r = dFdxFine(x);", "for (int k = 0; k < p.x; k++) r += 1.0; r += dFdx(x);",
    "if (nought < one) r = fwidth(x);", "if (p.x == 3) r = textureLod(pyramid_texture, uv, 1.0).x; r += texture(pyramid_texture, uv).x;",
    "r = p.x > 7 ? fwidth(x) : dFdy(x);", "if (p.x == 3) r = textureGrad(pyramid_texture, uv, vec2(0.1), vec2(0.1)).x;",
]
FINE = [
    "r = taps[i / 8];", "float a[7] = float[7](x, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0); r = a[i % 7];", "vec4 v = vec4(x); r = v[i / 16];",
    "mat2 m = mat2(x); r = m[i & 1].x;", "r = cells[i % 4].parts[i / 16];", "r = i < 8 ? taps[i] : 0.0;",
    "r = grid(ivec2(i % 8, i / 16)).x;", "if (i < 8) r = grid(ivec2(i, 0)).x;",
    "if (i < 32) stack_store(ivec3(i % 4, i / 4 % 4, i / 16), uvec4(1)); r = 1.0;",
    "r = float(7 / (i - 64));", "r = float(-2147483647 / (i - 5 == 0 ? 1 : i - 5));", "r = float((i + 3) % 5);", "r = float(-7 / 2);",
    "r = float(7u % uint(i + 1));", "r = float(1 << (i & 31));", "r = float(-8 >> i / 2);",
    "r = float(bitfieldExtract(i, i / 2, 1));", "r = float(clamp(i, 50, 50));", "r = float(int(x * 3.4e7));",
    "r = float(uint(x - zero));", "r = 1.0 / (x + 1.0);", "r = (x * 1e36) * 1.0;", "r = exp(x);", "r = sqrt(63.0 - x);",
    "r = max(x - 1.0, 0.0) + min(1.0, x / 3.0) + clamp(1.0 / (x + 1.0), 0.0, x) + max(uintBitsToFloat(0xff800000u), x);",
    "r = unpackHalf2x16(packHalf2x16(vec2(x * 1e3, uintBitsToFloat(0x7f800000u)))).x;",
    "r = log(x + 1.0);", "r = pow(x, 0.5);", "r = asin(x / 64.0);", "r = atan(x, 1.0);", "r = normalize(vec3(x, 1.0, zero)).y;",
    "r = smoothstep(x, 64.0, 5.0);", "r = clamp(5.0, x, 63.0);", "r = uintBitsToFloat(0x7f800000u) * one;",
    "r = isnan(uintBitsToFloat(0x7fc00000u + uint(i))) ? 1.0 : 2.0;",
    "for (int k = 0; k < 1000; k++) r += one;", "for (;;) { if (r > x) break; r += one; }",
    "for (int k = 0; k < 30; k++) for (int n = 0; n < 30; n++) r += one;", "while (r < x) r += one;",
    "do r += one; while (r < x);", "int k = 60000; while (k-- > 0) if (i > k) break; r = float(k);",
    "float u; if (i > 3) u = x; else u = 1.0; r = u;", "float u; if (i > 3) u = x; r = i > 3 ? u : 1.0;",
    "vec3 u; u.xy = vec2(x); r = u.x + u.y; vec2 w = u.yx; r += w.x;",
    "float best; bool found = false; for (int k = 0; k < 4; k++) if (!found || taps[k] > best) { best = taps[k]; found = true; } r = best;",
    "float a[4]; for (int k = 0; k < 4; k++) a[k] = x; r = a[i % 4];",
    "float a[4]; a[i % 4] = x; r = a[i % 4]; vec2 v; v[i & 1] = x; r += v[i & 1];",
    "float u; bool b = i > 3; if (b) u = x; if (b && u > 5.0) r = 1.0; if (x < 99.0 && b && u > 5.0) r = 2.0;",
    "float u; bool b = i > 3; if (b) u = x; if (!b || u < 5.0) r = 1.0; r += b ? u : 2.0;",
    "float w; r = modf(x * 0.5, w) + w; int e; r += frexp(x, e) + float(e);",
    "Cell c; c.parts = float[4](x, x, x, x); r = c.parts[i % 4];",
    "r = texelFetch(pyramid_texture, ivec2(i % 4, 0), i / 32).x + faces(ivec3(0, 0, i % 6)).x;",
    "Cell c; c.weight = x; Cell d = c; r = d.weight;",
    "float a[4]; a[1] = x; r = a[1]; mat2 m; m[0] = vec2(x); m[1] = m[0]; r += (m * vec2(x)).x;",
    "r = float(7u / uint(i + 1)); int k = 7; k %= i + 2; ivec2 q = ivec2(7) / ivec2(1, i + 9); r += float(q.y + bitfieldInsert(i, 3, i / 2, 1));",
    "r = acos(x / 64.0) + atanh(x / 64.0) + inversesqrt(x + 1.0) + pow(zero, one) + mix(x, 1e38, one) + ldexp(1.0, i) + inverse(mat2(1.0, x, 0.0, 1.0))[0].x;",
]
FINE_MEMORY = [
    # content
    "float v = sparse[i]; if (i % 2 == 0) r = v;", "float v = sparse[i]; r = i % 2 == 0 ? v : 1.0;",
    "vec4 v = vectors[i]; r = v.x + v.y;", "Cell c = partial[i % 4]; r = c.weight;", "r = sparse[i & 62]; uint k = steps[i];",
    "vec4 v = patchy(ivec2(i % 8, i / 8)); if (i % 2 == 0) r = v.x;", "r = f(i & 62);",
    "float v[2]; v[0] = sparse[i & 62]; v[1] = sparse[i | 1]; r = v[0];",
    "vec2 v = vec2(sparse[i], x); if (i == 64) r = v.x; r += v.y;",
    "float v = sparse[i]; bool even = i % 2 == 0; if (even && v > 0.5) r = 1.0;",
    # races
    "scratch[l] = 0.0; barrier(); scratch[l] = x; barrier(); r = scratch[l ^ 1];",
    "scratch[l] = x; barrier(); for (int k = 16; k > 0; k /= 2) { if (l < k) scratch[l] += scratch[l + k]; barrier(); } r = scratch[0];",
    "stack_atomicAdd(ivec3(1), 1u);", "if (l == 0) scratch[5] = x; barrier(); r = scratch[5];", "result[i] = x; result[i] = result[i] + one;",
    "scratch[l] = x; r = scratch[l]; barrier(); scratch[(l + 1) % 32] = r;", "if (i == 40) stack_store(ivec3(3, 3, 1), uvec4(0));",
    # control flow
    "barrier();", "for (int k = 0; k < 3; k++) barrier();", "g(); g();", "for (int k = 0; k < l; k++) r += 1.0; barrier();", "if (zero < one) barrier();", "if (gl_WorkGroupID.x == 0u) barrier();",
    "if (gl_WorkGroupID.x > 0u) return; barrier();", "if (l < 5) r = 1.0; else r = 2.0; barrier();",
]
FINE_FUNCTIONS = "shared float scratch[32];\nvoid g() { barrier(); }\nfloat f(int k) { float v = sparse[k]; return v * 2.0; }\n"


def write_spec(folder, name, bodies):
    draws = name.endswith("draw")
    outs = "".join(f"  out_{key}: {{{'format: rgba32f, size: [16, 16]' if draws else 'of: float, count: 64'}}}\n" for key in bodies)
    with open(os.path.join(folder, name + ".yaml"), "w", encoding="utf-8") as file:
        passes = "".join((DRAW if draws else PASS).format(key) for key in bodies)
        file.write(HEAD.format(name=name, buffers="" if draws else outs, images=outs if draws else "", passes=passes))
    for key, text in {**FILES, **bodies}.items():
        with open(os.path.join(folder, key + ".glsl"), "w", encoding="utf-8") as file:
            file.write(text)


def wrong_body(row):
    functions = row[4] if len(row) > 4 else ""
    return (draw_body if row in WRONG_DRAW else body)(row[0] if "// here" in functions + row[0] else row[0] + " // here", functions)


TABLES = {"wrong": WRONG, "wrong_memory": WRONG_MEMORY, "wrong_draw": WRONG_DRAW, "fine": FINE, "fine_memory": FINE_MEMORY, "fine_draw": FINE_DRAW}


def prefix(name):
    return "_".join([name[0], *name.split("_")[1:], ""])


def make(folder, seed="1"):
    source = random.Random(seed)
    for name, rows in TABLES.items():
        fine = name.startswith("fine")
        functions = FINE_FUNCTIONS if name == "fine_memory" else ""
        make_fine = draw_body if name == "fine_draw" else body
        bodies = {f"{prefix(name)}{i}": make_fine(row, functions) if fine else wrong_body(row) for i, row in enumerate(rows)}
        write_spec(folder, name, bodies)
        write_spec(folder, "some_" + name, {key: bodies[key] for key in source.sample(list(bodies), len(bodies) // 6 + 1)})
    few = {0, next(i for i, row in enumerate(WRONG) if row[1] == "sqrt")}
    write_spec(folder, "few", {f"w_{i}": wrong_body(WRONG[i]) for i in few})


def place(row):
    """Line, and column of the text that the message names; the sixth of a row: which one of equal texts."""
    lines = wrong_body(row).split("\n")
    line = next(i for i, text in enumerate(lines) if text.endswith("// here"))
    column = -1
    for _ in range(row[5] if len(row) > 5 else 1):
        column = re.compile((r"(?<!\w)" if row[1][0].isalnum() else "") + re.escape(row[1])).search(lines[line], column + 1).start()
    return line + 1, column + 1


def findings_of(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)["undefined"]


def rows_of(spec):
    """(pass, row) of the bodies in a spec."""
    name = os.path.basename(spec).removesuffix(".yaml").removeprefix("some_")
    with open(spec, encoding="utf-8") as file:
        passes = set(re.findall(r"- {name: (\w+),", file.read()))
    return [(f"{prefix(name)}{i}", row) for i, row in enumerate(TABLES[name]) if f"{prefix(name)}{i}" in passes]


def found(path, spec):
    findings, rows, bad = findings_of(path), rows_of(spec), 0
    for name, row in rows:
        own = [f for f in findings if f["pass"] == name]
        told = [(f["line"], f["column"], f["message"], f["invocation"][0]) for f in own]
        wanted = (*place(row), row[2], row[3])
        number = re.sub(r"(\d)e\+0", r"\1e+0", wanted[2]).replace("2.20000000e+09", "2.2e+09")
        right = [t for t in told if t[:2] == wanted[:2] and t[2].startswith(number) and t[3] == wanted[3]]
        if len(told) != 1 or not right:
            print(f"{row[0]}\n  wanted {wanted}\n  found {told}")
            bad += 1
    strange = [f for f in findings if not f["pass"].startswith("w")]
    print(f"{len(rows) - bad} of {len(rows)} found, {len(strange)} beside them")
    return bad or strange or not rows


def silent(path, spec):
    findings, rows = findings_of(path), dict(rows_of(spec))
    for finding in findings:
        print(finding, rows.get(finding["pass"], ""))
    return findings


def equal(a, b):
    names, others = (sorted(n for n in os.listdir(folder) if n != "manifest.json") for folder in (a, b))
    differ = [n for n in names if n in others and open(os.path.join(a, n), "rb").read() != open(os.path.join(b, n), "rb").read()]
    print(len(names), "files,", len(others), "files, different:", differ)
    return not names or names != others or differ


if __name__ == "__main__":
    sys.exit(1 if {"make": make, "found": found, "silent": silent, "equal": equal}[sys.argv[1]](*sys.argv[2:]) else 0)
