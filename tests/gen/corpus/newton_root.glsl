// A loop that ends when its value stands still.
// expect: 1.4142135 1.7320509
float root(float a)
{
    float x = a;
    for (int i = 0; i < 20; i++) {
        float next = 0.5 * (x + a / x);
        if (abs(next - x) < 1e-6)
            return next;
        x = next;
    }
    return x;
}
void main()
{
    result[0] = root(two);
    result[1] = root(three);
}
