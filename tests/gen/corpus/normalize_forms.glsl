// normalize divides by the length.
// expect: 0.6 0.8 0.26726124 -1
void main()
{
    vec2 v = normalize(vec2(three, two + two));
    result[0] = v.x;
    result[1] = v.y;
    result[2] = normalize(vec3(one, two, three)).x;
    result[3] = normalize(-three);
}
