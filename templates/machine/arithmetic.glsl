/* Products and sums in eight chains that do not wait for each other, enough for a processor's
 * pipelines; the factors keep every chain finite and unknown to the compiler. */
#define STEP   a = a * b + c; d = d * b + c;
#define STEP4  STEP STEP STEP STEP
#define STEP16 STEP4 STEP4 STEP4 STEP4

void main()
{
    int k = invocation().x;
    float seed = float(k) * 1e-6;
    vec4 a = vec4(seed, seed + 0.1, seed + 0.2, seed + 0.3);
    vec4 d = a + 0.5;
    float b = 0.75 + seed;
    float c = 0.25 - seed;
    STEP16 STEP16 STEP16 STEP16
    vec4 sum = a + d;
    results[k] = sum.x + sum.y + sum.z + sum.w;
}
