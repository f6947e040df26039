#ifdef VERTEX
void main()
{
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
}
#endif
#ifdef FRAGMENT
void main()
{
    columns = vec4(float(sums[int(gl_FragCoord.x)] & 255u) / 255.0);
}
#endif
