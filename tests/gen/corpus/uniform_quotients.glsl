// Long computations with parameters alone decide branches and fill arrays: lavapipe follows each of their paths, see exact.glsl.
// expect: 0.658037 3 1.9660102 0.5
// tolerance: ulp 20
void main()
{
    float v = sqrt(sqrt(three));
    int k = int(three);
    float a[2] = float[2](v, one);
    a[k & 1] = v / two;
    a[k & 1] /= two;
    a[k & 1] /= sqrt(two / three / two);
    result[0] = a[0] / two;
    if (pow(pow(half_ / three, two), log(three / two)) > exp(-sin(three) / two) / 3.0)
        result[1] = two;
    else
        result[1] = three;
    float weights[5], sum = 0.0;
    for (int i = 0; i < 5; i++) {
        weights[i] = exp(-float(i * i) / (2.0 * two * two));
        sum += weights[i];
    }
    result[2] = sum / 1.5;
    int turns = 0;
    for (int i = 0; i < int(ceil(mod(pow(two, three) / sqrt(three), two))); i++)
        turns++;
    result[3] = float(turns) * half_;
}
