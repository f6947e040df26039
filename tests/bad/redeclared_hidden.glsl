float min(float a, float b) { return a; }
vec3 luminance(vec3 light) { return min(light, vec3(1.0)); } /* another form than the body's */
void main() { picture_store(invocation().xy, vec4(luminance(vec3(min(gain, 1.0))), 1.0)); other_store(ivec2(taps), vec4(0)); }
