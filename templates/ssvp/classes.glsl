/* Index of the j-th VPL of an interleave class; each class needs a well spread subset. The
 * Hammersley set of VPLs is cut into blocks of class_count. Class c takes one VPL of each block,
 * rotated from block to block. For 256 VPLs and 16 classes each class is a cyclically shifted
 * Hammersley set of 16 points; k mod 16 would give a band, consecutive indices a strip. The
 * permutation is fixed, so classes see the same VPLs in every frame. */
int class_member(int c, int j)
{
    return j * class_count + (j + c) % class_count;
}
