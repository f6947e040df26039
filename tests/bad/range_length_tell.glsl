void main()
{
    uint count = uint(lights.length());
    for (vec4 light : row) { count++; }
    told[0] = count;
}
