// A vector turned by a quaternion.
// expect: -1 1 3
vec3 turn(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
void main()
{
    vec3 v = turn(vec4(0.0, 0.0, one, 0.0), vec3(one, -one, three));
    result[0] = v.x;
    result[1] = v.y;
    result[2] = v.z;
}
