// Ternaries in ternaries, in all places.
// expect: 1 2 3 4 7
float rank(float x)
{
    return x < 1.0 ? 1.0 : x < 2.0 ? 2.0 : x < 3.0 ? 3.0 : 4.0;
}
void main()
{
    result[0] = rank(half_);
    result[1] = rank(one);
    result[2] = rank(two);
    result[3] = rank(three);
    result[4] = (one > two ? three : one < two ? two > three ? one : two : half_) + 5.0 * one;
}
