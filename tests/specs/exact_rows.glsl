void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    vec4 a = inputs[i].a, b = inputs[i].b, s = inputs[i].s;
    mat4 m = mat4(a, b, s, a.wzyx);
    row_products[i].vec_mat4 = s * m;
    row_products[i].vec_mat4x3 = s.xyz * mat4x3(m);
    row_products[i].vec_mat3 = s.xyz * mat3(m);
    row_products[i].vec_mat2 = s.xy * mat2(m);
    row_products[i].mat4_mat4 = m * mat4(s.yzwx, b.zwxy, a.yxwz, s);
}
