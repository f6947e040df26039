// A macro has the meaning of its last definition above the use.
// expect: 1 2 3 3
#define V one
float first()
{
    return V;
}
#undef V
#define V two
float second()
{
    return V;
}
#undef V
#define V(x) (x)
void main()
{
    result[0] = first();
    result[1] = second();
    result[2] = V(three);
#undef V
    float V = three;
    result[3] = V;
}
