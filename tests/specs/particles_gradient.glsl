#ifdef VERTEX
layout(location = 0) out vec2 place;

void main()
{
    gl_Position = fullscreen_position();
    place = gl_Position.xy * 0.5 + 0.5;
}
#else
layout(location = 0) in vec2 place;

void main()
{
    marks = vec4(place, 0.0, 1.0);
}
#endif
