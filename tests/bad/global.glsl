float scale = 2.0; precise scale;
precise float sum = 0.0;
void main()
{
    precise float here = scale;
    sums[invocation().x] = sum + here;
}
