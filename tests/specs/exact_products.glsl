float third = 1.0 / 3.0;
vec4 sum; /* of the whole shader */

void add(vec4 a, vec4 b)
{
    sum += a * b * third;
}

struct Turn {
    mat3 m;
};

vec3 turned(const Turn turn, vec3 v)
{
    return turn.m * v;
}

void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    vec4 a = inputs[i].a, b = inputs[i].b, s = inputs[i].s;
    mat4 m = mat4(a, b, s, a.wzyx);
    products[i].mat4_vec = m * s;
    products[i].mat4x3_vec = mat4x3(m) * s;
    products[i].mat3_vec = mat3(m) * s.xyz;
    products[i].mat2_vec = mat2(m) * s.xy;
    products[i].mat4_point = m * vec4(s.xy, 1.0, 1.0);
    products[i].chain = 0.5 * transpose(m) * m * vec4(s.xy, 1.0, 0.0);
    const mat2 halves = mat2(1.0, 2.0, 3.0, 4.0) * 0.5;
    mat3 turns[2] = mat3[2](mat3(m), transpose(mat3(m)));
    products[i].held = vec4(-1.5e0 * (turns[1] * turned(Turn(turns[0]), vec3(s.xy, 1.0))), (halves * s.xy).x);
    sum = a;
    add(a, b);
    add(b, s);
    products[i].summed = sum;
}
