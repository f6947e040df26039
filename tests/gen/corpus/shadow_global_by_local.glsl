// A local variable, initialised by the global one of its name.
// expect: 1 5 7 1
float level = 1.0;
float read_level() { return level; }
void main()
{
    result[0] = level * one;
    float level = level + 4.0 * one;
    result[1] = level;
    {
        float level = level + two;
        result[2] = level;
    }
    result[3] = read_level();
}
