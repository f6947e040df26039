// Structs in structs and their constructors.
// expect: 3 7 5 1
struct Ray { vec3 origin, direction; };
struct Surface { int id; vec2 uv; };
struct Hit { Ray ray; float distance; Surface surface; };
vec3 at(Ray r, float t) { return r.origin + r.direction * t; }
void main()
{
    Hit hit;
    hit.ray = Ray(vec3(one), vec3(0.0, two, three));
    hit.distance = two;
    hit.surface.id = int(one);
    hit.surface.uv = vec2(half_, three);
    result[0] = hit.surface.uv.y;
    result[1] = at(hit.ray, hit.distance).z;
    result[2] = at(hit.ray, hit.distance)[1];
    result[3] = float(hit.surface.id);
}
