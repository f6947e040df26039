#define CORNER(k) scene_indices[k]

void main()
{
    int k = invocation().x;
    uint inner = scene_indices /* of [ */ [scene_indices[k % 3] % uint(scene_indices.length())];
    found[k] = inner + CORNER(k);
}
