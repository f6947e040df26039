// A sort by swaps in a macro.
// expect: 0.5 1 2 3
#define ORDER(a, b) { float low = min(a, b); b = max(a, b); a = low; }
void main()
{
    float v[4] = float[4](three, one, two, half_);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 3 - i; j++)
            ORDER(v[j], v[j + 1]);
    for (int i = 0; i < 4; i++)
        result[i] = v[i];
}
