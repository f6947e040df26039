// Quotients of whole numbers are whole: masks of pixels count on it.
// expect: 1 2 3 3 85 1
void main()
{
    float b = three;
    result[0] = floor(b / b);
    result[1] = floor(one * 6.0 / b);
    result[2] = floor(one * 9.0 / b);
    result[3] = floor(one * 15.0 / (two + three));
    float whole = 0.0;
    for (int i = 1; i <= 85; i++)
        if (floor(float(i) * three / three) == float(i) && fract(float(3 * i) / three) == 0.0)
            whole += one;
    result[4] = whole;
    result[5] = float(fract(float(int(three) * 7) / 7.0) == 0.0) + mod(9.0 * one, three);
}
