/* All of the viewport, or the half below its diagonal. */
#ifdef VERTEX
layout(location = 0) flat out float number;

void main()
{
    int k = gl_VertexIndex;
    vec2 corner = vec2(k == 1 || k == 4 || k == 5, k == 2 || k == 3 || k == 5);
    number = float(gl_InstanceIndex + 1);
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
#else
layout(location = 0) flat in float number;

void main()
{
    counted = vec4(number);
}
#endif
