// Cases that run into each other; default in the middle.
// expect: 111 11 1 5
float enter(int k)
{
    float s = 0.0;
    switch (k) {
    case 0:
        s += 100.0;
    case 1:
        s += 10.0;
    case 2:
        s += 1.0;
        break;
    default:
    case 3:
        s += 2.0;
    case 4:
        s += 3.0;
    }
    return s * one;
}
void main()
{
    result[0] = enter(0);
    result[1] = enter(1);
    result[2] = enter(2);
    result[3] = enter(77);
}
