// A table of constants that is read by a live index; a table in a closed scope of the same name.
// expect: 3 1 2
const float table[3] = float[3](1.0, 2.0, 3.0);
void main()
{
    result[0] = table[int(two)];
    {
        const float table[2] = float[](5.0, 1.0);
        result[1] = table[int(one)];
    }
    result[2] = table[int(one)];
}
