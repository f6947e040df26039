// Names made of parts.
// expect: 3 20 5 6
#define CAT(a, b) a##b
#define FIELD(n) weight_##n
#define DECLARE(T, n) T FIELD(n) = T(n)
void main()
{
    DECLARE(float, 3);
    DECLARE(float, 20);
    result[0] = FIELD(3) * one;
    result[1] = weight_20 * one;
    result[2] = CAT(t, wo) + CAT(thr, ee);
    result[3] = two * CAT(ma, x)(one, three);
}
