// Hyperbolic and inverse functions, near their true values.
// expect: 1.1752012 1.5430807 0.46211717 1.4436355 1.316958 0.54930615 1.0471976 1.2490457 0.57735026 0.034906585 28.64789
// tolerance: ulp 4
void main()
{
    result[0] = sinh(one);
    result[1] = cosh(one);
    result[2] = tanh(half_);
    result[3] = asinh(two);
    result[4] = acosh(two);
    result[5] = atanh(half_);
    result[6] = acos(half_);
    result[7] = atan(three);
    result[8] = inversesqrt(three);
    result[9] = radians(two);
    result[10] = degrees(half_);
}
