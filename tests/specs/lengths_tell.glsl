#define LENGTH(list) uint(list.length())

void main()
{
    told[0] = uint(one.length());
    told[1] = uint(three.length());
    told[2] = LENGTH(wide);
    told[3] = LENGTH(lamps);
    told[4] = uint(pairs.length());
    told[5] = LENGTH(counted);
    told[6] = uint(scene_vertices.length());
    told[7] = uint(scene_indices.length());
    told[8] = uint(scene_objects.length());
    told[9] = uint(one_count + three_count + wide_count + lamps_count + pairs_count + counted_count);
    /* The last element of each is its own. */
    told[10] = one[0] + uint(three[2]) + uint(wide[0].z) + uint(lamps[2].place.y);
    told[11] = uint(pairs[4].y + counted[counted.length() - 1].w);
    told[12] = scene_indices[scene_indices.length() - 1];
    told[13] = told[14] = told[15] = 0u;
}
