// Arguments over several lines, with comments and directives' look-alikes between.
// expect: 6 0.33333334 2
#define SUM3(a, b, c) (a + b + c)
#define QUOT(a, b) ((a) / (b))
void main()
{
    result[0] = SUM3(one, // the first
        two,              /* the second, */
        three             // the third)
    );
    result[1] = QUOT(
        one
        ,
        three
    );
    result
        [
            2
        ]
        =
        QUOT(two + two, two);
}
