void main()
{
    picture = vec4(float(sums[0] + gl_NumSubgroups));
}
