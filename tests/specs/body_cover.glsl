void main()
{
    vec2 uv = gl_FragCoord.xy / vec2(frame.width, frame.height);
    vec4 c = pyramid_sample(uv) + pyramid_sample_lod(uv, 1.0) + layers(ivec3(0, 0, 1)) + corners[0];
    c += textureGather(layers_texture, vec3(uv, 0.0)) + layers_depth(ivec3(0));
    over = c * depth_compare(uv, 0.5);
}
