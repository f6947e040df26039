#define SCALAR_PRODUCT dot
#define RATIO(a, b)    ((a) / (b))
void main()
{
    vec2 p = vec2(invocation().xy);
    picture_store(invocation().xy, vec4(SCALAR_PRODUCT(p, p)) + RATIO(p.x, p.y));
}
