// Parameters of a macro that have names of variables and of macros.
// expect: 3 2 1
#define x 100.0
#define F(x) (x + one)
#define G(one) (one)
#define H(two, one) ((two) - (one))
void main()
{
    result[0] = F(two);
    result[1] = G(two);
    result[2] = H(three, two);
}
