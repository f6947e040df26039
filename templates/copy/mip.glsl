/* A mip of the one above it: the mean of the four texels around its place there. */
void main()
{
    ivec2 size = from_size(), last = size - 1;
    vec2 place = gl_FragCoord.xy * vec2(size) / vec2(max(size / 2, 1)) - 0.5;
    ivec2 low = ivec2(floor(place));
    vec2 share = place - vec2(low);
    ivec2 a = clamp(low, ivec2(0), last), b = clamp(low + 1, ivec2(0), last);
    vec4 left = from(a) * (1.0 - share.y) + from(ivec2(a.x, b.y)) * share.y;
    vec4 right = from(ivec2(b.x, a.y)) * (1.0 - share.y) + from(b) * share.y;
    to = left * (1.0 - share.x) + right * share.x;
}
