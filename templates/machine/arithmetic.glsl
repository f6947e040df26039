/* Multiplies and adds in eight independent chains, enough to fill a processor's pipelines. The
 * factors keep every chain finite and are unknown to the compiler. Twenty steps: with 32, llvmpipe
 * runs out of registers and takes eight times as long. */
#define STEP  a = a * b + c; d = d * b + c;
#define STEP5 STEP STEP STEP STEP STEP

void main()
{
    ivec2 p = invocation().xy;
    float seed = float(p.x + p.y) * 1e-6;
    vec4 a = vec4(seed, seed + 0.1, seed + 0.2, seed + 0.3);
    vec4 d = a + 0.5;
    float b = 0.75 + seed;
    float c = 0.25 - seed;
    STEP5 STEP5 STEP5 STEP5
    a += d;
    results_store(p, vec4(a.x + a.y + a.z + a.w, 0.0, 0.0, 0.0));
}
