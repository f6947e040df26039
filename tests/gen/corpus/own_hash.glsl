// hash, noise, random and luminance as names of the body.
// expect: 3 5 14 1
float hash(float n) { return n + 2.0; }
float hash(vec2 p) { return p.x + p.y * 2.0; }
float random(float x) { return hash(x) * 2.0; }
const vec3 luminance = vec3(1.0, 2.0, 3.0);
float noise(vec3 p) { return dot(p, luminance); }
void main()
{
    result[0] = hash(one);
    result[1] = hash(vec2(one, two));
    result[2] = noise(vec3(one, two, three));
    result[3] = random(three) - 9.0;
}
