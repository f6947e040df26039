#ifdef VERTEX
layout(location = 0) flat out vec4 line[varyings];

void main()
{
    gl_Position = fullscreen_position();
    for (int i = 0; i < varyings; i++)
        line[i] = vec4(float(i));
}
#else
layout(location = 0) flat in vec4 line[varyings];

void main()
{
    seen = line[varyings - 1];
}
#endif
