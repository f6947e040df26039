void main() { sums[0].total = uint(WIDE + MOVING + BIG + LIST + FRACTION + UNKNOWN); pile[0] = 1u; }
