// Arguments are evaluated from left to right, operands too. Globals change in functions, in branches and in parts, or not at all.
// expect: 12 34 5 5.5
int state = 0;
float kept = 2.0, chosen = 3.0;
vec2 part = vec2(1.0);
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
    part.y = two;
    if (kept > one)
        chosen = half_;
    result[3] = (kept < chosen ? 100.0 : kept) + chosen + part.x + part.y;
}
