// Matrices in structs and arrays, as arguments and results.
// expect: 6 12 1
struct Frame { mat2 basis; vec2 origin; };
Frame scaled(Frame f, float by)
{
    f.basis *= by;
    f.origin *= by;
    return f;
}
void main()
{
    Frame frames[2];
    frames[0] = Frame(mat2(two, one, 0.0, two), vec2(one));
    frames[1] = scaled(frames[0], three);
    result[0] = frames[1].basis[0].x;
    result[1] = (frames[1].basis * vec2(one, one)).x + (frames[1].basis[0].y) + frames[1].origin.x;
    result[2] = frames[0].origin.y;
}
