/* A corner of a triangle: struct dt_vertex of diptych.h, nine scalars without padding. */
struct SceneVertex {
    float px, py, pz;
    float nx, ny, nz;
    float u, v;
    uint material;
};

/* struct dt_material of diptych.h. */
struct SceneMaterial {
    vec3 albedo;       /* linear, 0..1; multiplies the texture */
    int texture_layer; /* of scene_textures, or -1 */
    vec3 emission;
    float alpha_cutoff; /* texture alpha below this is a hole; 0: opaque */
};
