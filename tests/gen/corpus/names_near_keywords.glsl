// Names that begin with keywords or differ from them by case.
// expect: 6 3 1
float If(float form) { return form * two; }
struct Float { float int_; };
void main()
{
    float returned = three, inout_ = one, For = two, outer = half_;
    result[0] = If(returned);
    Float floats = Float(inout_ + For);
    result[1] = floats.int_;
    bool true_ = outer < inout_, not_ = !true_;
    result[2] = float(true_ && !not_);
}
