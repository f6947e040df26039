// Directives between arguments, and in a parameter list.
// expect: 2 3 1
float choose(float a,
#if 1
    float b
#else
    float c
#endif
)
{
    return a *
#if 1
        b
#else
        c
#endif
        ;
}
void main()
{
    result[0] = choose(one,
#ifndef SOMETHING
        two
#else
        three
#endif
    );
    result[1] = max(
#if 0
        one,
#endif
        two, three);
    result[2] = min(one,
#if defined(SOMETHING)
        half_
#else
        two
#endif
    );
}
