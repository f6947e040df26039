// CUBE_TYPE and CUBE_NAME are given.
CUBE_TYPE CUBE_NAME(CUBE_TYPE x)
{
    return x * x * x;
}
