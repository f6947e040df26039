// A matrix divided by a number is divided component by component, rounded once; a product with a reciprocal is another number.
// expect: 0.60000002384185791015625 0.60000002384185791015625 0.4285714328289031982421875 1.3333333730697631835937500 5 4 0.6000000238418579 0.42857146263
void main()
{
    float five = two + three, n = 0.0;
    mat2 m = mat2(one, two, three, two + two);
    result[0] = (m / five)[1][0];
    m /= (n += five);
    result[1] = m[1][0];
    mat4x3 wide = mat4x3(three);
    wide = wide / (two + five);
    result[2] = wide[2][2];
    mat3x2 tall = mat3x2(two + two);
    const float third = 3.0;
    tall /= third;
    result[3] = tall[1][1];
    result[4] = n;
    result[5] = (m * five)[1][1];
    result[6] = (mat2(three * three) * (one / (three * five)))[0][0];
    result[7] = (mat2(three) * (one / (two + five)))[1][1];
}
