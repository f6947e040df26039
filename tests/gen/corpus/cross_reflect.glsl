// cross, reflect and faceforward of whole numbers.
// expect: -1 2 -1 1 -3 2 -2
void main()
{
    vec3 a = vec3(one, two, three), b = vec3(three, 4.0, 5.0);
    vec3 c = cross(vec3(one, one, one), a);
    result[0] = -c.x;
    result[1] = -c.y;
    result[2] = -c.z;
    vec2 r = reflect(vec2(one, three), vec2(0.0, one));
    result[3] = r.x;
    result[4] = r.y;
    result[5] = faceforward(two, one, -three);
    result[6] = cross(a, b).x;
}
