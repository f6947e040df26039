// Structs are compared by their fields.
// expect: 1 0 1
struct Pair { vec2 a; int b; };
void main()
{
    Pair p = Pair(vec2(one, two), 3), q = Pair(vec2(one, three - one), int(three));
    result[0] = float(p == q);
    q.b++;
    result[1] = float(p == q);
    result[2] = float(p != q);
}
