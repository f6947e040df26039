void main()
{
    ivec2 p = interleave_pixel(), size = color_size();
    float sum = 0.0;
    for (Point v : some) {
        sum += v.place.x;
    }
    bool same = lace_gather(lace_split(p, size), size) == p && lace_class(p) == interleave_class();
    same = same && tile_gather(tile_split(p, size, lace_tile), size, lace_tile) == p;
    same = same && tile_class(tile_offset(interleave_class(), lace_tile), lace_tile) == lace_class(p);
    same = same && tile_class_size(0, size, lace_tile) == lace_class_size(0, size) && lace_classes == 4;
    if (all(equal(p / lace_tile, invocation().xy))) /* others repeat the last pixel */
        laced_store(interleave_split(), vec4(sum, float(same), color(p).xy));
}
