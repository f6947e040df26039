void main() { other_store(ivec2(invocation().xy), vec4(1.0)); }
