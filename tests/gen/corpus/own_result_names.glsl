// Locals that have names of parameters and of the output.
// expect: 1 5 6
float total(float result[2]) { return result[0] + result[1]; }
float tri(float one, float two) { return one * two; }
void main()
{
    result[0] = one;
    result[1] = total(float[2](two, three));
    {
        float one = two;
        float two = three;
        result[2] = tri(one, two);
    }
}
