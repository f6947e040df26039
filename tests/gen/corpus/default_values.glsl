// Assignments to all components one by one; a value set on each path.
// expect: 0 1 7
float choose(bool first)
{
    float value;
    if (first)
        value = 0.0;
    else
        value = 1.0;
    return value * one;
}
void main()
{
    result[0] = choose(true);
    result[1] = choose(one > two);
    vec3 v;
    v.x = one;
    v.y = two;
    v[2] = 4.0 * one;
    result[2] = v.x + v.y + v.z;
}
