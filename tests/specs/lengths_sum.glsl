void main()
{
    float sum = 0.0;
    for (vec4 each : row) {
        sum += each.x;
    }
    summed[0] = uint(counted.length()) * 100u + uint(sum);
}
