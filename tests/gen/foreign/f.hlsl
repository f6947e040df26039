Texture2D photo : register(t0);
SamplerState soft : register(s1);
SamplerState hard : register(s2);
struct Room { float4 tint; float2x3 turn; };
cbuffer Values : register(b3) { Room room; };
float4 take(Texture2D from, SamplerState by, float2 uv) { return from.Sample(by, uv); }
float4 main(float4 place : SV_Position, float2 uv : TEXCOORD0) : SV_Target
{
    return room.tint * room.turn[1][2] + take(photo, soft, uv) * 2 + photo.Sample(hard, uv) * 4 + photo.Load(int3(0, 0, 0)) * 8 + float4(uv, 0, 0);
}
