// Sums with carry and products of 64 bits.
// expect: 0 1 4294967300.0 1 1 1
void main()
{
    uint carry, borrow, high, low;
    result[0] = float(uaddCarry(0xffffffffu, uint(one), carry));
    result[1] = float(carry);
    result[2] = float(usubBorrow(0u, uint(one), borrow));
    result[3] = float(borrow);
    umulExtended(0x80000000u, uint(two), high, low);
    result[4] = float(high);
    result[5] = float(low) + one;
}
