void main() { ivec2 p = ivec2(invocation().xy); pyramid_store(p, pyramid(p) + pyramid_sample(vec2(0.5))); }
