// A file that includes a file that includes a file.
// expect: 11 22 33
#include "include/chain_first.glsl"
void main()
{
    result[0] = chain_first(one);
    result[1] = chain_second(one);
    result[2] = chain_third(one);
}
