// A switch over an unsigned number, and one inside another.
// expect: 20 7
void main()
{
    uint u = uint(two);
    switch (u) {
    case 1u: result[0] = 10.0; break;
    case 2u: result[0] = 20.0 * one; break;
    }
    switch (int(one)) {
    case 1:
        switch (int(two)) {
        case 1: result[1] = 1.0; break;
        case 2: result[1] = 7.0 * one; break;
        }
        break;
    case 2: result[1] = 2.0;
    }
}
