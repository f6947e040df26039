// break leaves the switch, continue the turn.
// expect: 15 4 3
void main()
{
    float s = 0.0;
    int turns = 0, ends = 0;
    for (int i = 0; i < 4; i++) {
        turns++;
        switch (i) {
        case 1:
            continue;
        case 2:
            s += 4.0;
            break;
        default:
            s += 5.0 + half_;
        }
        ends++;
    }
    result[0] = s;
    result[1] = float(turns) * one;
    result[2] = float(ends) * one;
}
