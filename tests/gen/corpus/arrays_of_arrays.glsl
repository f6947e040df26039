// Arrays of arrays, in both spellings.
// expect: 23 6 3 2 12
float[3][2] table;
float other[2][3] = float[2][3](float[3](1.0, 2.0, 3.0), float[3](4.0, 5.0, 6.0));
float first_of(float row[2]) { return row[0]; }
void main()
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 2; j++)
            table[i][j] = float(10 * i + j) + two;
    result[0] = table[2][1];
    result[1] = other[1][2] * one;
    result[2] = float(table.length()) * one;
    result[3] = float(table[0].length()) * one;
    result[4] = first_of(table[1]);
}
