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

/* 1 / x within 2e-7, also of negative numbers. */
float reciprocal_close(float x)
{
    float r = reciprocal_estimate(x);
    return r + r * (1.0 - x * r);
}

float sqrt_estimate(float x)
{
#ifdef EXACT
    return x * exact_root_estimate(x);
#else
    return sqrt(x);
#endif
}
