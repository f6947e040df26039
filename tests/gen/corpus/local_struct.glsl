// A struct declared in a function, twice with one name.
// expect: 6 2
float f()
{
    struct Local { float a; float b; };
    Local l = Local(two, three);
    return l.a * l.b;
}
float g()
{
    struct Local { float b; } l;
    l.b = two;
    return l.b;
}
void main()
{
    result[0] = f();
    result[1] = g();
}
