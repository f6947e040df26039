// Arguments are evaluated from left to right, operands too.
// expect: 12 34 5
int state = 0;
float note(int digit) { state = state * 10 + digit; return float(digit); }
float take(float a, float b) { return a + b; }
void main()
{
    take(note(1), note(2));
    result[0] = float(state) * one;
    state = 0;
    float x = note(3) - note(4);
    result[1] = float(state) * one;
    result[2] = x + two * three;
}
