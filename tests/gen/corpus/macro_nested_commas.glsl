// Commas in parentheses do not part arguments; empty arguments are arguments.
// expect: 3 7 5
#define FIRST(a, b) a
#define OPTIONAL(a, b) a b
#define ID(x) x
void main()
{
    result[0] = FIRST(max(one, three), two);
    result[1] = OPTIONAL(three + two * two,);
    result[2] = ID(vec2(two, three)).x + ID(three);
}
