// Arrays and structs as in, out and inout arguments.
// expect: 6 14 3
struct Bag { float items[3]; };
float sum(const float a[3]) { return a[0] + a[1] + a[2]; }
void square(inout float a[3]) { for (int i = 0; i < 3; i++) a[i] *= a[i]; }
void pack(out Bag bag, in float a[3]) { bag.items = a; }
void main()
{
    float a[3] = float[3](one, two, three);
    result[0] = sum(a);
    Bag bag;
    pack(bag, a);
    square(bag.items);
    result[1] = sum(bag.items);
    result[2] = a[2];
}
