/* Which triangles a cluster's map draws, and in which list: 1 for those within one view of the
 * pyramid, 2 for those across views (map_triangles.glsl). Not those behind the plane through the eye,
 * and not those within a view that cover no texel centre, which are most others in finely meshed
 * scenes (Wihlidal, GDC 2016).
 *
 * Rasterizers snap corners to a grid, up
 * to 1/512 of a texel away with the usual 8 bits, and arithmetic rounds. So triangles closer than
 * SNAP to a centre stay. Triangles across the horizon stay, too: their projection has no bounds. No
 * branches: drivers that run on CPUs then keep all values in registers. */

#include "../shared/estimate.glsl"
#include "map.glsl"

const float SNAP = 1.0 / 256.0;
const int ROWS = 4; /* a triangle across more rows nearly always covers a centre */

vec3 local_of(vec3 d, ClusterView v)
{
    return vec3(dot(d, v.tangent), dot(d, v.bitangent), dot(d, v.normal));
}

/* x, y: texels; z: height over the eye's plane. */
vec3 place(vec3 local)
{
    float middle = 0.5 * float(map_size);
    return vec3(local.xy * (middle * reciprocal_close(reach_of(local))) + middle, local.z);
}

bool both_signs(float a, float b, float c)
{
    return min(min(a, b), c) < 0.0 && max(max(a, b), c) > 0.0;
}

/* Views border on x = y and x = -y. */
bool lies_across(vec3 a, vec3 b, vec3 c)
{
    return both_signs(a.x - a.y, b.x - b.y, c.x - c.y) || both_signs(a.x + a.y, b.x + b.y, c.x + c.y);
}

/* Whether the triangle covers one of the texel centres (0, 0) to `last`, in at most ROWS rows.
 * `turn`: 1 if wound from x to y, else -1. In each row, every edge bounds the inside along x. */
bool covers_centre(vec2 a, vec2 b, vec2 c, float turn, vec2 last)
{
    vec3 x = vec3(a.y - b.y, b.y - c.y, c.y - a.y) * turn; /* inward normal of each edge */
    vec3 y = vec3(b.x - a.x, c.x - b.x, a.x - c.x) * turn;
    vec3 inner = x * vec3(a.x, b.x, c.x) + y * vec3(a.y, b.y, c.y) - SNAP * (abs(x) + abs(y));
    x.x = x.x == 0.0 ? 1e-20 : x.x; /* edge along the rows: its bound lies far outside the row */
    x.y = x.y == 0.0 ? 1e-20 : x.y;
    x.z = x.z == 0.0 ? 1e-20 : x.z;
    vec3 part = vec3(reciprocal_close(x.x), reciprocal_close(x.y), reciprocal_close(x.z));
    vec3 place = inner * part;
    vec3 slope = y * part;
    bool covers = false;
    for (int row = 0; row < ROWS; row++) {
        vec3 edge = place - slope * float(row);
        float from = max(max(x.x > 0.0 ? edge.x : 0.0, x.y > 0.0 ? edge.y : 0.0),
                         max(x.z > 0.0 ? edge.z : 0.0, 0.0));
        float to = min(min(x.x > 0.0 ? last.x : edge.x, x.y > 0.0 ? last.x : edge.y),
                       min(x.z > 0.0 ? last.x : edge.z, last.x));
        covers = covers || (float(row) <= last.y && ceil(from) <= to);
    }
    return covers;
}

bool draws_triangle(vec3 a, vec3 b, vec3 c, bool across)
{
    float slack = 1e-5 * frame.scene_radius;
    bool behind = max(max(a.z, b.z), c.z) < -slack;
    bool before = min(min(a.z, b.z), c.z) > slack;
    vec2 first = ceil(min(min(a.xy, b.xy), c.xy) - (0.5 + SNAP)) + 0.5;
    vec2 last = floor(max(max(a.xy, b.xy), c.xy) - (0.5 - SNAP)) + 0.5 - first;
    bool between = last.x < 0.0 || last.y < 0.0;
    /* Rows run along the longer side. */
    bool tall = last.y > last.x;
    vec2 p = a.xy - first;
    vec2 q = b.xy - first;
    vec2 r = c.xy - first;
    p = tall ? p.yx : p;
    q = tall ? q.yx : q;
    r = tall ? r.yx : r;
    last = tall ? last.yx : last;
    /* Twice the area. The winding is uncertain if the area is within its rounding error, which
     * grows with the length of the triangle. */
    float area = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    bool few = abs(area) > 1e-3 * max(last.x, 1.0) && last.y < float(ROWS);
    bool beside = few && !covers_centre(p, q, r, area > 0.0 ? 1.0 : -1.0, last);
    return !behind && !(before && !across && (between || beside));
}

uint keeps_triangle(vec3 a, vec3 b, vec3 c, ClusterView v)
{
    vec3 p = local_of(a - v.position, v);
    vec3 q = local_of(b - v.position, v);
    vec3 r = local_of(c - v.position, v);
    bool across = lies_across(p, q, r);
    bool drawn = draws_triangle(place(p), place(q), place(r), across);
    return drawn && v.member >= 0 ? (across ? 2u : 1u) : 0u;
}
