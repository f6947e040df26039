#version 450
layout(input_attachment_index = 0, binding = 0) uniform subpassInput under;
layout(binding = 1) uniform sampler2DMS many;
layout(binding = 2) uniform sampler2D maps[3];
layout(binding = 3) uniform texture2D loose[2];
layout(binding = 4) uniform sampler nearest[2];
layout(binding = 5, rgba32f) uniform image2D kept;
layout(location = 0) out vec4 color;
void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    int k = p.x + 1;
    color = vec4(subpassLoad(under).x + 8 * textureSamples(many), texelFetch(many, p, 3).y + textureSize(many).x,
                 texelFetch(maps[k], p, 0).x * 16 + imageLoad(kept, p).x, texture(sampler2D(loose[k], nearest[p.y]), vec2(0.2)).x + textureSize(maps[2], 0).x);
}
