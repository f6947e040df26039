// Globals that have names of the generator's uniforms and structs.
// expect: 3 4 5 9
struct Frame { float index; };
struct SceneVertex { float px; };
Frame frame = Frame(3.0);
float camera = 4.0;
float scene_radius(float x) { return x + 2.0; }
vec2 view = vec2(9.0);
void main()
{
    frame.index *= one;
    result[0] = frame.index;
    result[1] = camera * one;
    result[2] = scene_radius(three);
    SceneVertex vertex = SceneVertex(view.x);
    result[3] = vertex.px * one;
}
