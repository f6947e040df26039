// Blanks and tabs around the sign of a directive.
// expect: 2 4 1
  #  define   SPACED    two
	#	define TABBED	(two	+ two)
#   if   1
    #   define INSIDE one
#   endif
void main()
{
    result[0] = SPACED;
    result[1] = TABBED;
		result[2]	=	INSIDE	;
}
