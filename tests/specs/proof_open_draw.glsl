#ifdef VERTEX
layout(location = 0) out vec2 place;

void main()
{
    place = vec2(gl_VertexIndex % 3 >> 1, gl_VertexIndex & 1) * 4.0 - 1.0;
    gl_Position = vec4(place, 0.5, 1.0);
}
#endif

#ifdef FRAGMENT
layout(location = 0) in vec2 place;

void main()
{
    vec2 corner = gl_FragCoord.xy;
    seen = vec4(corner, gl_FragCoord.z, place.x - dFdx(place.y));
}
#endif
