#include "shared/space.glsl"
void main()
{
    if (invocation().x == 0)
        number[0] = number[0] * 10u + uint(DIGIT);
}
