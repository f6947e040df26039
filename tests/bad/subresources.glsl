void main() { fine = current = coarse_sample(vec2(0)) + before(ivec2(0)); }
