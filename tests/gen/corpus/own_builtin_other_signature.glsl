// A built-in's name for other arguments; the built-in stays for its own.
// expect: 10 2 7 0.5
float pow(vec2 v) { return v.x * 10.0; }
float sqrt(int n) { return float(n) + 4.0; }
struct Pair { float a, b; };
float max(Pair p) { return p.a; }
void main()
{
    result[0] = pow(vec2(one, two));
    result[1] = sqrt(two + two);
    result[2] = sqrt(int(three));
    result[3] = max(max(Pair(half_, one)), -one);
}
