// transpose, determinant, outerProduct and matrixCompMult of whole numbers.
// expect: 3 -5 2 6 4
void main()
{
    mat2 m = mat2(one, two, three, one);
    result[0] = transpose(m)[0][1];
    result[1] = determinant(m);
    result[2] = outerProduct(vec3(one, two, three), vec2(one, two))[1].x;
    result[3] = outerProduct(vec2(two), vec2(three))[1].y;
    result[4] = matrixCompMult(m, mat2(4.0 * one))[0].x;
}
