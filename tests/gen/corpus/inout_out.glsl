// Parameters that are written: swizzles, elements and fields as arguments.
// expect: 3 6 2 1 4
struct Box { float size; };
void grow(inout float x, float by) { x += by; }
void make(out float x, out int n) { x = two; n = 4; }
void main()
{
    vec3 v = vec3(one, two, three);
    grow(v.x, two);
    result[0] = v.x;
    float list[2] = float[2](one, three);
    grow(list[int(one)], three);
    result[1] = list[1];
    Box box = Box(0.0);
    int n;
    make(box.size, n);
    result[2] = box.size;
    result[3] = list[0];
    result[4] = float(n) * one;
}
