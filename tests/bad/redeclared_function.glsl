void other_store(ivec2 p, vec4 v) { picture_store(p, v + float(half_width) * gain); }
void main() { other_store(invocation().xy, vec4(1.0)); }
