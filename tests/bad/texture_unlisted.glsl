void main() { picture_store(ivec2(invocation().xy), texelFetch(other_texture, ivec2(0), 0)); }
