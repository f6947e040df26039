// The right side of && and || runs only if it is needed; of ^^ always.
// expect: 0 1 1 2 2
int runs = 0;
bool ran(bool value) { runs++; return value; }
void main()
{
    bool a = one > two && ran(true);
    result[0] = float(runs) * one;
    bool b = one > two || ran(true);
    result[1] = float(runs) * one;
    bool c = one < two || ran(false);
    result[2] = float(runs) * one;
    bool d = one < two ^^ ran(false);
    result[3] = float(runs) * one;
    result[4] = float(a) + float(b) + float(c) + float(d) - one;
}
