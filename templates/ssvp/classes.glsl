/* Which VPL is the j-th of an interleave class: each class must see a well spread subset. The VPLs
 * of a Hammersley set come in blocks of class_count; class c takes one of each, rotated from block
 * to block. For 256 VPLs and 16 classes that leaves every class a cyclically shifted Hammersley set
 * of 16 points, where k mod 16 would leave a band and a run of indices a strip. The permutation is
 * fixed, so classes see the same VPLs in every frame. */
int class_member(int c, int j)
{
    return j * class_count + (j + c) % class_count;
}
