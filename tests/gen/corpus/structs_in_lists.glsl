// A struct declared with its variables.
// expect: 3 2 5
struct Pair { float a, b; } first = Pair(3.0, 4.0), second;
const struct Fixed { float value; } fixed_value = Fixed(5.0);
void main()
{
    second = Pair(one, two);
    result[0] = first.a * one;
    result[1] = second.b;
    result[2] = fixed_value.value * one;
}
