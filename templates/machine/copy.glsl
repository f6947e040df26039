/* Copies every texel once, sixteen bytes each way. */
void main()
{
    ivec2 p = invocation().xy;
    copied_store(p, original(p));
}
