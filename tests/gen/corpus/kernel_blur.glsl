// A blur over a list with clamped indices.
// expect: 1.36 1.85 1.92 1.4 1.3 1.67
const int RADIUS = 2;
const float kernel[RADIUS + 1] = float[RADIUS + 1](0.4, 0.24, 0.06);
void main()
{
    float row[6] = float[6](one, two, three, half_, one, two);
    for (int i = 0; i < 6; i++) {
        float sum = row[i] * kernel[0];
        for (int k = 1; k <= RADIUS; k++)
            sum += (row[max(i - k, 0)] + row[min(i + k, 5)]) * kernel[k];
        result[i] = sum;
    }
}
