// A block's constant hides a parameter, for the block alone.
// expect: 4 3 13
float scaled(float gain)
{
    {
        const float gain = 4.0;
        result[0] = gain * one;
    }
    return gain * one;
}
void main()
{
    result[1] = scaled(three);
    const float three = 13.0;
    result[2] = three * one;
}
