// A ray and a sphere: early returns and an out argument.
// expect: 2 -1 2.1339746
bool hit(vec3 origin, vec3 direction, float radius, out float t)
{
    t = -1.0;
    float b = dot(origin, direction);
    float c = dot(origin, origin) - radius * radius;
    float d = b * b - c;
    if (d < 0.0)
        return false;
    t = -b - sqrt(d);
    return t > 0.0;
}
void main()
{
    float t;
    result[0] = hit(vec3(0.0, 0.0, -three), vec3(0.0, 0.0, one), one, t) ? t : 100.0;
    hit(vec3(0.0, two, -three), vec3(0.0, 0.0, one), one, t);
    result[1] = t;
    hit(vec3(0.0, half_, -three), vec3(0.0, 0.0, one), one, t);
    result[2] = t;
}
