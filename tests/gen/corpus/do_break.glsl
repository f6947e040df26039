// break leaves a loop that has no other end.
// expect: 2
void main()
{
    do {
        result[0] = two;
        if (one > half_)
            break;
        result[0] = three;
    } while (true);
}
