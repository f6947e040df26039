#version 450
#ifdef VERTEX
layout(location = 0) in vec2 place;
void main() { gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0); }
#else
layout(location = 0) out vec4 color;
layout(push_constant) uniform Push { vec2 size; float gain; } push;
void main() { color = vec4(gl_FragCoord.xy / push.size, push.gain, 1.0); }
#endif
