struct Out { float4 place : SV_Position; float2 uv : TEXCOORD0; };
Out main(uint id : SV_VertexID)
{
    Out o;
    o.uv = float2(id << 1 & 2, id & 2);
    o.place = float4(2 * o.uv - 1, 0, 1);
    return o;
}
