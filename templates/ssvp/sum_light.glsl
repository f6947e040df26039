/* Flux and area of the VPLs that use an eye, which the light of the second bounce leaves from. */
void main()
{
    int e = invocation().x;
    if (e >= eyes_count)
        return;
    vec3 flux = vec3(0.0);
    float area = 0.0;
    for (int k = 0; k < points_count; k++) {
        if (nearest[k] != e)
            continue;
        flux += points[k].flux;
        area += points[k].area;
    }
    eyes[e].flux = flux;
    eyes[e].power = flux.r + flux.g + flux.b;
    eyes[e].area = area;
}
