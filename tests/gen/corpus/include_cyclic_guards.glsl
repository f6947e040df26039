// Two files that include each other.
// expect: 3 5
#include "include/left.glsl"
void main()
{
    result[0] = left_value(two);
    result[1] = right_value(two);
}
