void main() { ivec2 p = ivec2(invocation().xy); coarser_store(p, coarser(p)); finer_store(p, pyramid(p)); }
