// Numbers in all their spellings.
// expect: 26 8 255 1000 0.015625 0.5 5 120
void main()
{
    result[0] = float(0x1A) * one;
    result[1] = float(010) * one;
    result[2] = float(0XFFu) * one;
    result[3] = 1e3 * one;
    result[4] = 15625.e-6f * one;
    result[5] = .5 * one;
    result[6] = 5. * one;
    result[7] = 1.2E+2F * one;
}
