// Default precisions of other APIs.
// expect: 0.21000001 300 70001
// fast: skip
precision mediump float;
precision lowp int;
lowp float shade(lowp float x) { return x * 0.7; }
void main()
{
    lowp float x = 0.1 * three;
    result[0] = shade(x);
    mediump int n = 100 * int(three);
    result[1] = float(n);
    lowp int large = 70000 + int(one);
    result[2] = float(large);
}
