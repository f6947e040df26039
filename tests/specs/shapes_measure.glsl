void main()
{
    if (invocation().xy != ivec2(0))
        return;
    sizes_store(ivec2(0, 0), ivec4(fog_size(), 0));
    sizes_store(ivec2(1, 0), ivec4(sky_size(), faces_size()));
    sizes_store(ivec2(2, 0), ivec4(probes_size(), 0, 0));
    sizes_store(ivec2(3, 0), ivec4(faces(ivec3(6, 5, 3)) * 16.0));
    sizes_store(ivec2(4, 0), ivec4(fog(ivec3(7, 5, 4)) * 100.0));
    /* On the edge between two faces. */
    sizes_store(ivec2(5, 0), ivec4(sky_sample(vec3(1.0, 0.0, 1.0)) * 1000.0));
}
