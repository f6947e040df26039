float twice(float x)
{
    if (x < 0.0)
        return x * x * x * x; /* leaves early: does not count */
    return x + x; /* 1 */
}

void main()
{
    int k = invocation().x;
    if (k >= 1000)
        return;
    vec3 v = inputs[k] * shift;             /* 3 */
    float sum = v.x + v.y;                  /* 1 */
    if (sum > 1.0)
        sum = sqrt(sum) * sum - v.z;        /* 3, the dearer way */
    else
        sum = -sum + 1.0;                   /* 1 */
    for (int i = 0; i < rows; i++) {
        if (v.z > float(i))
            break;
        sum = sum * 0.5 + twice(sum);       /* 3 with the call */
    }
    outputs[k] = clamp(sum, 0.0, v.x) / v.y; /* 3 */
}
