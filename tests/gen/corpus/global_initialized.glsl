// Globals with initial values, one made of another, changed in functions.
// expect: 5 2 3
int calls = 2;
float start = 3.0;
float base = start * 1.0;
void touch() { calls += 3; base = base - 1.0; }
void main()
{
    touch();
    result[0] = float(calls) * one;
    result[1] = base * one;
    result[2] = start * one;
}
