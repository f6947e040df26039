// Only the chosen side of a ternary is evaluated.
// expect: 1 5 5 1 3
int calls = 0;
float count(float x) { calls++; return x; }
void main()
{
    float x = one < two ? count(5.0 * one) : count(count(two));
    result[0] = float(calls) * one;
    result[1] = x;
    int i = 5, j = 1;
    int k = two > three ? i++ : j++;
    result[2] = float(i) * one;
    result[3] = float(k) * one;
    result[4] = float(j) + one;
}
