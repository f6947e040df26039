// A generator of integers and its scale to floats.
// expect: 0.6591631 0.49632204 5
uint pcg(inout uint state)
{
    state = state * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}
float unit(uint bits) { return float(bits >> 8) / 16777216.0; }
void main()
{
    uint state = uint(one);
    result[0] = unit(pcg(state));
    state = uint(three);
    result[1] = unit(pcg(state));
    result[2] = float((state - state) + 5u);
}
