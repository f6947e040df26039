#extension GL_EXT_spirv_intrinsics : require
/* NMin, NMax and NClamp, and comparisons that hold for NaN, as other compilers write them. */
spirv_instruction(set = "GLSL.std.450", id = 79) float same_min(float x, float y);
spirv_instruction(set = "GLSL.std.450", id = 80) float same_max(float x, float y);
spirv_instruction(set = "GLSL.std.450", id = 81) float same_clamp(float x, float low, float high);
spirv_instruction(id = 185) bool less_or_unordered(float x, float y);
spirv_instruction(id = 182) bool ordered_not_equal(float x, float y);

const uint NUMBERS[12] = uint[](0u, 0x80000000u, 0x3f000000u, 0xbf000000u, 0x3f800000u, 0xbf800000u, 0x40000000u, 0xc0000000u,
                                0x7f800000u, 0xff800000u, 0x7fc00000u, 0xffc00000u);

void main()
{
    int i = invocation().x;
    float x = uintBitsToFloat(NUMBERS[i / 12] | uint(zero)), y = uintBitsToFloat(NUMBERS[i % 12] | uint(zero));
    Chosen c;
    c.x = x;
    c.y = y;
    c.least = min(x, y);
    c.most = max(x, y);
    c.inside = clamp(x, -0.0, abs(y));
    c.at_least = max(x, 0.0);
    c.at_most = min(0.0, x);
    c.unit = clamp(x, 0.0, 1.0);
    c.ends = min(max(vec2(x), vec2(-0.0, 0.5)), vec2(y, 0.0));
    c.between = clamp(x, -1.0, 0.5);
    c.proven = vec4(max(abs(x), abs(y)), min(abs(x), abs(y)), max(x * x, abs(y)), clamp(0.5, x, 2.0)); /* short: ranges.c */
    c.whole = ivec2(int(floor(clamp(x * 1.5e9, -2147483648.0, 2147483520.0))), int(float(2u - (x < y ? 1u : 5u)))); /* wraps */
    c.written = vec4(x * 0.0, 0.0 + x, 0.0 - x, dot(vec2(x, y), vec2(0.0, 1.0))); /* which Mesa's drivers fold */
    c.scaled = vec3(x, y, x) * vec3(-0.0, 2.0, 0.0);
    c.shares = vec2(mix(x, y, 0.0), mix(x, y, 1.0));
    c.same_least = same_min(x, y);
    c.same_most = same_max(-1.0, x);
    c.same_inside = same_clamp(x, 0.0, 1.0);
    c.stepped = step(x, y);
    c.eased = smoothstep(-1.0, 1.0, x);
    c.mixed = mix(x, y, 0.5);
    c.picked = mix(x, y, !(x < y));
    c.compared = uint(x < y) | uint(x <= y) << 1 | uint(x > y) << 2 | uint(x >= y) << 3 | uint(x == y) << 4 | uint(x != y) << 5
        | uint(!(x < y)) << 6 | uint(!(x >= y)) << 7 | uint(isnan(x)) << 8 | uint(isinf(x)) << 9 | uint(x != x) << 10
        | uint(less_or_unordered(x, y)) << 11 | uint(ordered_not_equal(x, y)) << 12;
    _CHOSEN__MAX[i] = c; /* a name that C alone reserves */
}
