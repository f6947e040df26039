// Vectors of vectors, numbers, matrices and other types.
// expect: 1 3 2 0.5 1 2 4
void main()
{
    vec4 v = vec4(vec2(one, two), three, half_);
    result[0] = vec3(v).x;
    result[1] = vec3(v).z;
    result[2] = vec2(ivec2(v.xy)).y;
    result[3] = vec3(v.w).z;
    result[4] = vec2(bvec2(two > one, false)).x;
    result[5] = vec2(uvec3(1u, 2u, 3u)).y * one;
    result[6] = vec4(mat2(one, two, three, 4.0)).w;
}
