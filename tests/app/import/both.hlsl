struct Corner { float4 place : SV_Position; float2 far[2] : COLOR; float2 uv : TEXCOORD0; };
Corner VSMain(uint id : SV_VertexID)
{
    Corner c;
    c.uv = float2(id << 1 & 2, id & 2); c.far[0] = 50; c.far[1] = 0;
    c.place = float4(2 * c.uv - 1, 0, 1);
    return c;
}
float4 PSMain(float2 uv : TexCoord, float2 far : color1) : SV_Target
{
    float list[4] = {1, 2, 3, 4}; clip(uv.y - 0.2);
    return list[int(uv.x * 3 + far.x) + 1] + ddx(uv.x);
}
