// No blanks where none are needed.
// expect: 0.33333334 3 5 2
float f(float a,float b){return a/b;}
void main(){float x=one,y=two;result[0]=f(x,three);result[1]=x+y;result[2]=x- -y+y;int i=1;result[3]=float(i+++1)*x;}
