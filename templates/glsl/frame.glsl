/* What is new in every frame: struct dt_frame of diptych.h, std140. */
struct View {
    mat4 view;
    mat4 projection;
    mat4 view_projection;
    mat4 inverse_view_projection;
    vec3 position;
    float near_plane;
    vec3 direction; /* unit, into the view */
    float far_plane;
};

struct Light {
    vec3 position; /* spot */
    int kind;      /* 0 directional, 1 spot */
    vec3 direction; /* unit, the way that light travels */
    float area;
    vec3 color; /* directional: irradiance, W/m2; spot: intensity on the axis, W/sr */
    float cos_inner;
    float cos_outer;
};

layout(@layout@) uniform Frame {
    View camera;
    View light_view;
    Light light;
    vec3 scene_center;
    float scene_radius;
    uint width;
    uint height;
    uint index;
    uint triangle_count;
} frame;
