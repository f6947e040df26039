void main()
{
    float turned = 0.0;
    for (int k = 0; k < turns; k++)
        turned += 1.0;
    float beyond = level[64 + int(zero)] * zero;
    sum[0] = turned + beyond;
}
