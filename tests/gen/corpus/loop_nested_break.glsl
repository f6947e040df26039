// A break leaves one loop only.
// expect: 3 11
void main()
{
    int outer = 0, inner = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 10; j++) {
            inner++;
            if (j == i + 2)
                break;
        }
        outer++;
    }
    result[0] = float(outer) * one;
    result[1] = float(inner - 1) * one;
}
