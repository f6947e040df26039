// PI as a macro, with another value.
// expect: 6 2.25 3.5
#define PI 3.0
#define INV_PI (1.0 / PI)
float arc(float PI_2) { return PI_2 + half_; }
void main()
{
    result[0] = PI * two;
    result[1] = 0.75 * PI * one;
    result[2] = arc(INV_PI * PI * three);
}
