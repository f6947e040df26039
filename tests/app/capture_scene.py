"""capture_scene.py FAULT: a small renderer in OpenGL, without anything of diptych, for capture_test.sh. Three passes into textures,
the last into the window, all frames alike; FAULT plants one difference."""
import ctypes
import sys

gl, glfw = ctypes.CDLL("libGL.so.1"), ctypes.CDLL("libglfw.so.3")
FAULT = sys.argv[1]
SIDE = 96
TEXTURE_2D, FRAMEBUFFER, COLOUR, DEPTH = 0xDE1, 0x8D40, 0x8CE0, 0x8D00
DEPTH_TEST, CULL_FACE, BLEND, POLYGON_OFFSET_FILL = 0xB71, 0xB44, 0xBE2, 0x8037

HEAD = "#version 330 core\n"
WHOLE = HEAD + """void main() { vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1); gl_Position = vec4(p * 4.0 - 1.0, 0.0, 1.0); }"""
SOLID = HEAD + """out vec3 colour; uniform mat4 place; const vec2 at[6] = vec2[](vec2(-.8, -.7), vec2(.7, -.8), vec2(.1, .8),
vec2(-.5, .6), vec2(.4, .5), vec2(.6, -.4)); void main() { vec2 p = at[gl_VertexID]; colour = vec3(p * .5 + .5, .3);
gl_Position = place * vec4(p, p.x * .4 + float(gl_VertexID / 3) * .1, 1.0); }"""
COLOURED = HEAD + "in vec3 colour; layout(location = 0) out vec4 result; void main() { result = vec4(colour, 1.0); }"
BLUR = HEAD + """uniform sampler2D scene; uniform float radius; uniform float iTime; layout(location = 0) out vec4 result;
void main() { vec2 p = TURN / 96.0; vec4 sum = vec4(0.0); for (int i = -2; i <= 2; i++) sum += texture(scene, p + vec2(float(i) + SHIFT, 0.0)
* radius / 96.0); result = sum * 0.2 + iTime * 0.1; }"""
TONE = HEAD + """uniform sampler2D blurred; uniform float exposure; layout(location = 0) out vec4 result;
void main() { vec2 p = TURN / 96.0; result = vec4(1.0 - exp(-texture(blurred, p).rgb * exposure), 1.0); }"""


def compiled(vertex: str, fragment: str) -> int:
    program = gl.glCreateProgram()
    for kind, text in ((0x8B31, vertex), (0x8B30, fragment)):
        shader, source = gl.glCreateShader(kind), ctypes.c_char_p(text.encode())
        gl.glShaderSource(shader, 1, ctypes.byref(source), None)
        gl.glCompileShader(shader)
        gl.glAttachShader(program, shader)
    gl.glLinkProgram(program)
    linked = ctypes.c_int()
    gl.glGetProgramiv(program, 0x8B82, ctypes.byref(linked))
    assert linked.value
    return program


def made(function: str) -> int:
    name = ctypes.c_uint()
    getattr(gl, function)(1, ctypes.byref(name))
    return name.value


def texture(internal: int, form: int, kind: int) -> int:
    name = made("glGenTextures")
    gl.glBindTexture(TEXTURE_2D, name)
    gl.glTexImage2D(TEXTURE_2D, 0, internal, SIDE, SIDE, 0, form, kind, None)
    for parameter, value in ((0x2801, 0x2601), (0x2800, 0x2601), (0x2802, 0x812F), (0x2803, 0x812F)):
        gl.glTexParameteri(TEXTURE_2D, parameter, value)
    return name


def target(depth: bool) -> tuple[int, int]:
    frame, colour = made("glGenFramebuffers"), texture(0x8058, 0x1908, 0x1401)
    gl.glBindFramebuffer(FRAMEBUFFER, frame)
    gl.glFramebufferTexture2D(FRAMEBUFFER, COLOUR, TEXTURE_2D, colour, 0)
    if depth:
        gl.glFramebufferTexture2D(FRAMEBUFFER, DEPTH, TEXTURE_2D, texture(0x8CAC, 0x1902, 0x1406), 0)
    return frame, colour


def uniform(program: int, name: str, *values: float) -> None:
    place = gl.glGetUniformLocation(program, name.encode())
    numbers = (ctypes.c_float * len(values))(*values)
    if len(values) == 16:
        gl.glUniformMatrix4fv(place, 1, 0, numbers)
    else:
        gl.glUniform1fv(place, 1, numbers)


def use(program: int, frame: int, read: int = 0) -> None:
    gl.glBindFramebuffer(FRAMEBUFFER, frame)
    gl.glViewport(0, 0, SIDE, SIDE)
    gl.glUseProgram(program)
    gl.glBindTexture(TEXTURE_2D, read)


def switch(state: int, on: bool) -> None:
    (gl.glEnable if on else gl.glDisable)(state)


def main() -> None:
    gl.glClearColor.argtypes = [ctypes.c_float] * 4
    gl.glPolygonOffset.argtypes = [ctypes.c_float] * 2
    glfw.glfwCreateWindow.restype = ctypes.c_void_p
    glfw.glfwInit()
    for hint, value in ((0x22002, 3), (0x22003, 3), (0x22008, 0x32001)):
        glfw.glfwWindowHint(hint, value)
    window = ctypes.c_void_p(glfw.glfwCreateWindow(SIDE, SIDE, b"scene", None, None))
    glfw.glfwMakeContextCurrent(window)
    array = ctypes.c_uint()
    gl.glGenVertexArrays(1, ctypes.byref(array))
    gl.glBindVertexArray(array)
    turned = FAULT == "rows"
    straight, over = "gl_FragCoord.xy", "vec2(gl_FragCoord.x, 96.0 - gl_FragCoord.y)"
    solid = compiled(SOLID, COLOURED)
    blur = compiled(WHOLE, BLUR.replace("TURN", over if turned else straight).replace("SHIFT", "1.0" if FAULT == "shader" else "0.0"))
    tone = compiled(WHOLE, TONE.replace("TURN", over if turned else straight))
    scene, blurred, again = target(True), target(False), target(False)
    for _ in range(1000):
        use(solid, scene[0])
        switch(DEPTH_TEST, True)
        switch(BLEND, False)
        switch(CULL_FACE, FAULT == "cull")
        switch(POLYGON_OFFSET_FILL, True)
        gl.glPolygonOffset(*((1.0, 0.1) if FAULT == "offset" else (0.1, 1.0)))
        gl.glClearColor(0.1, 0.2, 0.3, 1.0)
        gl.glClear(0x4100)
        uniform(solid, "place", *(float(at % 5 == 0) for at in range(16)))
        gl.glDrawArrays(4, 0, 6)
        for state in (DEPTH_TEST, CULL_FACE, POLYGON_OFFSET_FILL):
            switch(state, False)
        for program, frame, read in ((blur, blurred, scene), (tone, again, blurred), (tone, (0, 0), blurred)):
            use(program, frame[0], read[1])
            uniform(program, "radius", 2.0)
            uniform(program, "iTime", 0.49 if FAULT == "clock" else 0.22)
            uniform(program, "exposure", 1.25 if FAULT == "uniform" else 1.0)
            gl.glDrawArrays(4, 0, 3)
        glfw.glfwSwapBuffers(window)
        glfw.glfwPollEvents()


main()
