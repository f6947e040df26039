#ifdef FRAGMENT
void main()
{
    face = vec4(9.0);
}
#endif
