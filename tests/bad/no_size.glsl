#ifdef VERTEX
void main() { gl_Position = vec4(0.0); }
#endif
#ifdef FRAGMENT
void main() { picture = vec4(1.0); }
#endif
