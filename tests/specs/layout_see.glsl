/* What the shader sees in the live block that C wrote. */
void main()
{
    if (invocation().x > 0)
        return;
    seen[0].gain = gain;
    seen[0].tint = tint;
    seen[0].steps = steps;
    seen[0].grid = grid;
    seen[0].flag = flag ? 1 : 0;
}
