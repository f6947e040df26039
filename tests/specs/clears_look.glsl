#define JOIN(a, b) a##b /* a sample that no text shows: the view must decode, also for the fetch */
void main()
{
    ivec2 p = invocation().xy;
    seen_store(p, vec4(coded(p).xy, JOIN(tex, tureLod)(coded_texture, vec2(0.5), 0.0).xy));
}
