// Matrices of numbers, vectors, smaller and larger matrices.
// expect: 1 0 2 3 1 3 7
void main()
{
    mat3 small = mat3(vec3(one, two, three), vec3(4.0 * one), vec3(7.0, 8.0, 9.0) * one);
    mat4 large = mat4(small);
    result[0] = large[3][3];
    result[1] = large[3][0];
    result[2] = mat2(small)[0][1];
    mat2 mixed = mat2(one, vec2(two, three), 4.0);
    result[3] = mixed[1][0];
    mat2x4 tall = mat2x4(mat2(one));
    result[4] = tall[1][1];
    result[5] = mat3x4(large)[0][2];
    result[6] = small[2].x;
}
