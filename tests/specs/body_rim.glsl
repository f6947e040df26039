#ifdef VERTEX
layout(location = 0) out vec2 place;

void main()
{
    gl_Position = fullscreen_position();
    place = gl_Position.xy;
}
#else
layout(location = 0) in vec2 place;

void main()
{
    over = vec4(abs(place), 0.0, 1.0);
    if (max(abs(place.x), abs(place.y)) < 0.75)
        discard;
}
#endif
