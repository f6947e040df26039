// Comments that look like other comments: /* /* // */
// expect: 1 2 3 4 5
//****************************************************
//* see sources/*.glsl
// and /* never closed
/* // */
/*/ this is still a comment /*/
/***/
/**/
void main()
{
    result[0] = one; //*
    result[1] = two; /* result[1] = three; // */ result[2] = three; //*/ result[2] = one;
    /* one
     * two // three
     **/
    result[3] = two /* / */ * /* * */ two; // /* \o/
    result[4] = two + /**/ three /*/ /*/;
}
