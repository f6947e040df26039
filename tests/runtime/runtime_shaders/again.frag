#version 450
layout(location = 0) flat in uint v_layer;
layout(location = 0) out uint layer;

void main()
{
    layer = v_layer + 21;
}
