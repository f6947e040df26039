/* A corner of a triangle: struct dt_vertex of diptych.h, ten scalars without padding. */
struct SceneVertex {
    float px, py, pz;
    float nx, ny, nz;
    float u, v;
    uint material;
    uint object;
};

/* struct dt_material of diptych.h. */
struct SceneMaterial {
    vec3 albedo;       /* linear, 0..1; multiplies the texture */
    int texture_layer; /* of scene_textures, or -1 */
    vec3 emission;
    float alpha_cutoff; /* texture alpha below this is a hole; 0: opaque */
};

/* struct dt_object of diptych.h. */
struct SceneObject {
    mat4 transform; /* of the mesh's own space to the scene */
    mat4 inverse;
    vec3 center;
    float radius;
    uint first_index;
    uint index_count;
    uint material;
    uint mesh; /* the same number: instances of one mesh */
};
