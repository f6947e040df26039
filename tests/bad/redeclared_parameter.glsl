#define TYPE float
TYPE gain = 2.0;
const int taps = 3;
void main() { picture_store(invocation().xy, vec4(gain * float(taps))); }
