// A list of fields, expanded three times.
// expect: 3 1 20 300 321
#define FIELDS(X) \
    X(red, 1.0) \
    X(green, 20.0) \
    X(blue, 300.0)
struct Paint
{
#define DECLARE(name, value) float name;
    FIELDS(DECLARE)
#undef DECLARE
};
#define COUNT(name, value) + 1
const int fields = 0 FIELDS(COUNT);
#define VALUE(name, value) value * one,
#define ADD(name, value) + p.name
void main()
{
    float values[fields + 1] = float[](FIELDS(VALUE) 0.0);
    Paint p = Paint(values[0], values[1], values[2]);
    result[0] = float(fields);
    result[1] = p.red;
    result[2] = p.green;
    result[3] = p.blue;
    result[4] = 0.0 FIELDS(ADD);
}
