// All of main on one line, with macros of semicolons.
// expect: 1 2 3
#define END ;
#define BEGIN {
#define DONE }
void main() BEGIN result[0] = one END float x = two END result[1] = x END if (x > one) BEGIN result[2] = three END DONE DONE
