#ifdef VERTEX
layout(location = 0) flat out uvec4 number;

void main()
{
    vec2 corner = vec2(gl_VertexIndex % 3 >> 1, gl_VertexIndex % 3 & 1) * 0.25;
    number = uvec4(gl_VertexIndex, gl_InstanceIndex, numbers[gl_InstanceIndex].of[gl_VertexIndex], 7);
    gl_Position = vec4(corner + vec2(gl_InstanceIndex & 7, gl_InstanceIndex >> 3) * 0.25 - 1.0, 0.5, 1.0);
}
#endif

#ifdef FRAGMENT
layout(location = 0) flat in uvec4 number;

void main()
{
    if (gl_FragCoord.x > 30.0 && gl_FragCoord.y < 3.0)
        discard;
    drawn = number + uvec4(gl_FragCoord.xy, gl_FrontFacing, 0u);
}
#endif
