void main() { if (invocation().x < lights.length()) lights[invocation().x] = vec4(1.0); }
