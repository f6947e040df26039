#define SCALAR_PRODUCT dot
void main()
{
    vec2 p = vec2(invocation().xy);
    picture_store(invocation().xy, vec4(SCALAR_PRODUCT(p, p)));
}
