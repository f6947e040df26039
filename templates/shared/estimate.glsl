/* Reciprocals and square roots of positive normal numbers, for light that ends in half floats: within
 * 3e-6 and 2e-5. */
float reciprocal_estimate(float x)
{
    return approximate_reciprocal_estimate(x);
}

/* 1 / x within 2e-7, also of negative numbers. */
float reciprocal_close(float x)
{
    float r = reciprocal_estimate(x);
    return r + r * (1.0 - x * r);
}

float sqrt_estimate(float x)
{
    return x * approximate_root_estimate(x);
}
