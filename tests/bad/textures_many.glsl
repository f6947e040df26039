void main()
{
    ivec2 p = invocation().xy;
    float sum = scene_vertices[scene_indices[0]].px;
    sum += i1(p).x + i2(p).x + i3(p).x + i4(p).x + i5(p).x + i6(p).x;
    sum += i7(p).x + i8(p).x + i9(p).x + i10(p).x + i11(p).x + i12(p).x;
    sum += i13(p).x + i14(p).x + i15(p).x + i16(p).x + i17(p).x + i18(p).x;
    sum += i19(p).x + i20(p).x + i21(p).x + i22(p).x;
    sum_store(p, vec4(sum));
}
