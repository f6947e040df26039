// Constants in a loop's head and body, and a loop variable of their name.
// expect: 6 2.5 10
const float step_size = 2.0;
void main()
{
    float sum = 0.0;
    for (const float step_size = one; sum < 6.0; sum += step_size)
        ;
    result[0] = sum;
    for (float step_size = half_; step_size < 2.0; step_size += 2.0)
        result[1] = step_size + step_size * 4.0;
    sum = 0.0;
    for (int i = 0; i < 5; i++)
        sum += step_size * one;
    result[2] = sum;
}
