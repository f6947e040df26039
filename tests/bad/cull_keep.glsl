bool keeps_triangles(vec3 a, vec3 b, vec3 c)
{
    return true;
}
