void main()
{
    int i = invocation().x;
    uint digit = keys[i] >> SHIFT & 3u, place = 0u;
    for (int j = 0; j < keys_count; j++) {
        uint other = keys[j] >> SHIFT & 3u;
        place += uint(other < digit || (other == digit && j < i));
    }
    places[i] = place;
}
