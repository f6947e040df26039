/* The direction through a texel of a face, as OpenGL and Vulkan lay the faces out. */
vec3 direction(ivec3 p, float size)
{
    vec2 c = 2.0 * (vec2(p.xy) + 0.5) / size - 1.0;
    return p.z == 0   ? vec3(1.0, -c.y, -c.x)
           : p.z == 1 ? vec3(-1.0, -c.y, c.x)
           : p.z == 2 ? vec3(c.x, 1.0, c.y)
           : p.z == 3 ? vec3(c.x, -1.0, -c.y)
           : p.z == 4 ? vec3(c.x, -c.y, 1.0)
                      : vec3(-c.x, -c.y, -1.0);
}

void main()
{
    ivec3 p = invocation();
    if (all(lessThan(p.xy, coarser_size())) && p.z < 6)
        coarser_store(p, finer_sample(direction(p, float(coarser_size().x))));
}
