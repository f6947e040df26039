// Structs with names that a renderer has, too.
// expect: 1 2 6 5
struct Light { vec3 color; float intensity; };
struct View { vec3 position; };
struct Camera { View view; float fov; };
vec3 lit(Light light, View view) { return light.color * light.intensity + view.position; }
void main()
{
    Light light = Light(vec3(one), two);
    View view = View(vec3(two));
    Camera camera = Camera(view, half_);
    result[0] = light.color.g;
    result[1] = camera.view.position.x;
    result[2] = lit(Light(vec3(two), two), camera.view).z;
    result[3] = camera.fov * 10.0;
}
