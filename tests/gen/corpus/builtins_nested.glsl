// Calls in calls in indices and arguments.
// expect: 1.316074 2 0.57735026 3 1.3333333
void main()
{
    result[0] = sqrt(sqrt(three));
    float list[3] = float[3](one, two, three);
    result[1] = list[int(floor(min(sqrt(three), two)))];
    result[2] = one / sqrt(max(three, min(one, two)));
    result[3] = max(max(one, two), max(three, half_));
    result[4] = mix(one, mix(one, two, one), one / three);
}
