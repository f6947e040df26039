/* What VIEW can see, the camera's if not defined: not triangles with all corners behind one of its
 * planes. SLACK keeps triangles that arithmetic leaves undecided. */
#ifndef VIEW
#define VIEW camera
#endif

bool keeps_triangle(vec3 a, vec3 b, vec3 c)
{
    const float SLACK = 1e-5;
    vec4 p = VIEW.view_projection * vec4(a, 1.0);
    vec4 q = VIEW.view_projection * vec4(b, 1.0);
    vec4 r = VIEW.view_projection * vec4(c, 1.0);
    vec3 w = vec3(p.w, q.w, r.w) + SLACK * abs(vec3(p.w, q.w, r.w));
    vec3 x = vec3(p.x, q.x, r.x);
    vec3 y = vec3(p.y, q.y, r.y);
    vec3 z = vec3(p.z, q.z, r.z);
    bool beside = all(greaterThan(x, w)) || all(greaterThan(-x, w));
    bool above = all(greaterThan(y, w)) || all(greaterThan(-y, w));
    bool behind = all(lessThan(z, -SLACK * abs(w))) || all(greaterThan(z, w));
    return !beside && !above && !behind;
}
