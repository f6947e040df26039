void main()
{
    int k = invocation().x + invocation().y;
    float twice = 2.0 * float(k); /* 1 */
    if (k < 1000)
        inputs[k] = vec3(outputs[k], twice, 0.0);
}
