/* Tone mapping (Reinhard et al. 2002, Equations 2 and 4) on luminance, then the sRGB curve and 8
 * bits. */
#include "srgb.glsl"

void main()
{
    ivec2 size = radiance_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    vec3 colour = radiance(p).rgb * luminance_scale[0];
    float luminance = dot(colour, vec3(0.2126, 0.7152, 0.0722));
    float whitest = reciprocal_close(white * white);
    colour *= (1.0 + luminance * whitest) * reciprocal_close(1.0 + luminance);
    vec3 codes = vec3(srgb(approximate_clamp(colour.r, 1.0)), srgb(approximate_clamp(colour.g, 1.0)),
                      srgb(approximate_clamp(colour.b, 1.0)));
    codes = floor(codes * 255.0 + 0.5);
    display_store(p, vec4(codes * (1.0 / 255.0), 1.0));
}
