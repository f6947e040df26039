/* One component, two, three and four in x, y, z and w, where a function takes vectors of any size. */
void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    vec4 a = inputs[i].a, b = inputs[i].b, s = inputs[i].s;
    geometry[i].dots = vec4(dot(a.x, b.x), dot(a.xy, b.xy), dot(a.xyz, b.xyz), dot(a, b));
    geometry[i].lengths = vec4(length(a.x), length(a.xy), length(a.xyz), length(a));
    geometry[i].distances =
        vec4(distance(a.x, b.x), distance(a.xy, b.xy), distance(a.xyz, b.xyz), distance(a, b));
    geometry[i].unit = normalize(a);
    geometry[i].mixed = mix(a, b, s);
    geometry[i].mixed_evenly = mix(a, b, s.x);
    geometry[i].mirrored = reflect(a, s);
    geometry[i].bent = refract(normalize(a), normalize(b), 0.75 + 0.25 * s.x);
    geometry[i].forward = faceforward(a, b, s);
    geometry[i].crossed = cross(a.xyz, b.xyz);
}
