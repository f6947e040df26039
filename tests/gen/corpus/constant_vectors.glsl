// Constants of vectors are folded by component.
// expect: 0.07 1 0.33333334 0.2236068
const vec2 base = vec2(0.1, 0.2);
const vec2 scaled = base * vec2(0.7, 0.3);
const vec2 moved = base * 3.0 + 0.2;
void main()
{
    result[0] = scaled.x * one;
    result[1] = moved.x * two;
    result[2] = (vec3(1.0) / vec3(3.0)).y * one;
    result[3] = length(base) * one;
}
