shared float lost[area + width];
void main()
{
    lost[0] = float(room);
    picture_store(invocation().xy, vec4(lost[0]));
}
