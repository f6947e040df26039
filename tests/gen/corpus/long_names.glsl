// Names that differ at their ends.
// expect: 3 2
float a_name_of_a_value_that_is_longer_than_what_one_would_ever_type_and_longer_still_x(float v) { return v + two; }
float a_name_of_a_value_that_is_longer_than_what_one_would_ever_type_and_longer_still_y(float v) { return v + one; }
void main()
{
    result[0] = a_name_of_a_value_that_is_longer_than_what_one_would_ever_type_and_longer_still_x(one);
    result[1] = a_name_of_a_value_that_is_longer_than_what_one_would_ever_type_and_longer_still_y(one);
}
