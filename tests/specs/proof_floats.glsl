#extension GL_EXT_spirv_intrinsics : require
/* Comparisons that hold for NaN, as other compilers write them. */
spirv_instruction(id = 181) bool unordered_equal(float a, float b);
spirv_instruction(id = 185) bool unordered_less(float a, float b);
spirv_instruction(id = 187) bool unordered_greater(float a, float b);
spirv_instruction(id = 189) bool unordered_less_equal(float a, float b);
spirv_instruction(id = 191) bool unordered_greater_equal(float a, float b);

float number(uint bits)
{
    return uintBitsToFloat((bits & 0x87ffffffu) + 0x3c000000u); /* 2^-7 to 2^8 */
}

void main()
{
    int at = invocation().x;
    float x = number(numbers[at].of[0]), y = number(numbers[at].of[1]), z = number(numbers[at].of[2]);
    vec4 v = vec4(x, y, z, number(numbers[at].of[3]));
    mat2 m = mat2(x, y, z, v.w);
    int power;
    float whole, digits = frexp(x, power);

    Floats r;
    r.of[0] = x + y * z - x;
    r.of[1] = -x;
    r.of[2] = roundEven(x) + trunc(y);
    r.of[3] = floor(x) + ceil(y);
    r.of[4] = abs(x) + sign(y) + step(x, y);
    r.of[5] = float(uint(abs(x))) + float(int(y));
    r.of[6] = float(numbers[at].of[4] >> 1);
    r.of[7] = float(x < y) + float(x > y) + float(x <= y) + float(x >= y) + float(x == y) + float(x != y);
    r.of[8] = float(isnan(x)) + float(isinf(y)) + float(unordered_equal(x, y)) + float(unordered_less(x, y))
        + float(unordered_greater(x, y)) + float(unordered_less_equal(x, y)) + float(unordered_greater_equal(x, y));
    r.of[9] = digits + float(power);
    r.of[10] = modf(z, whole) + whole;
    r.of[11] = (v * z).w + (m * z)[1].x;
    r.of[12] = (transpose(m))[0].y + outerProduct(v.xy, v.zw)[1].x;
    r.of[13] = x > 0.0 ? y : z;
    r.of[14] = float(int(numbers[at].of[5]));
    r.of[15] = uintBitsToFloat(floatBitsToUint(x) ^ 0x80000000u);
    floats[at] = r;
}
