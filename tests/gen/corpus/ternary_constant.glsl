// A ternary of constants as a length, and a constant condition before live sides.
// expect: 2 4 3
const bool WIDE = true;
const int N = WIDE ? 4 : 2;
void main()
{
    float list[N];
    list[N - 1] = WIDE ? two : three;
    result[0] = list[3];
    result[1] = float(list.length()) * one;
    result[2] = false ? one : three;
}
