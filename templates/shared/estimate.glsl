/* Reciprocals and square roots of positive normal numbers, for light that ends in half floats: within
 * 3e-6 and 2e-5. Exact pipelines take less than half of the operations of `/` and `sqrt`. */
float reciprocal_estimate(float x)
{
#ifdef EXACT
    return exact_reciprocal_estimate(x);
#else
    return 1.0 / x;
#endif
}

float sqrt_estimate(float x)
{
#ifdef EXACT
    return x * exact_root_estimate(x);
#else
    return sqrt(x);
#endif
}
