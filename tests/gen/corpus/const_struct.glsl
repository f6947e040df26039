// Constant structs and arrays, and their fields as constants.
// expect: 1 6 20
struct Kernel
{
    int taps;
    vec3 weights;
};
const Kernel kernels[2] = Kernel[2](Kernel(1, vec3(1.0, 2.0, 3.0)), Kernel(4, vec3(4.0, 5.0, 6.0)));
void main()
{
    float list[kernels[1].taps];
    list[3] = kernels[0].weights[0];
    result[0] = list[3] * one;
    result[1] = kernels[int(one)].weights.z;
    result[2] = float(kernels[1].taps) * kernels[1].weights.y * one;
}
