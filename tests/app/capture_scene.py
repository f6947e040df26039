"""capture_scene.py [NAME...]: a small renderer in OpenGL, without anything of diptych, for capture_test.sh. All frames are alike:
three passes into textures, the last into the window. Each NAME is a fault; the frame that has it becomes NAME.rdc, through
RenderDoc's interface for programs. `cover` is a frame with all kinds of targets, `covered` the same with a fault in each."""
import ctypes
import os
import sys
from typing import Any

gl, glfw = ctypes.CDLL("libGL.so.1"), ctypes.CDLL("libglfw.so.3")
SIDE = 96
TEXTURE_2D, ARRAY, CUBE, VOLUME, SAMPLES, FRAMEBUFFER, COLOUR, DEPTH = 0xDE1, 0x8C1A, 0x8513, 0x806F, 0x9100, 0x8D40, 0x8CE0, 0x8D00
DEPTH_TEST, CULL_FACE, BLEND, OFFSET, SCISSOR, DISCARD = 0xB71, 0xB44, 0xBE2, 0x8037, 0xC11, 0x8C89
STORAGE, RGBA8, CLAMP = 0x90D2, 0x8058, 0x812F

HEAD = "#version 330 core\n"
WHOLE = HEAD + """void main() { vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1); gl_Position = vec4(p * 4.0 - 1.0, 0.0, 1.0); }"""
SOLID = HEAD + """layout(location = 0) in vec2 spot; out vec3 colour; uniform mat4 place;
void main() { vec2 p = spot; colour = vec3(p * .5 + .5, .3);
gl_Position = place * vec4(p, p.x * .2 + float(gl_VertexID / 3) * .05 + .5, 1.0); }"""
COLOURED = HEAD + "in vec3 colour; layout(location = 0) out vec4 result; uniform sampler2D still;" """
layout(std140) uniform Light { float gain; vec4 tint; } light;
void main() { result = vec4(colour, light.gain) * light.tint + textureLod(still, colour.rg, 1.0) * 0.1; }"""
BLUR = HEAD + """uniform sampler2D scene; uniform float radius; uniform float iTime; layout(location = 0) out vec4 result;
void main() { vec2 p = TURN / 96.0; vec4 sum = vec4(0.0); for (int i = -2; i <= 2; i++) sum += texture(scene, p + vec2(float(i) + SHIFT, 0.0)
* radius / 96.0); result = sum * 0.2 + iTime * 0.1; }"""
TONE = HEAD + """uniform sampler2D blurred; uniform float exposure; layout(location = 0) out vec4 result;
void main() { vec2 p = TURN / 96.0; result = vec4(1.0 - exp(-texture(blurred, p).rgb * exposure), 1.0); }"""


NEW = "#version 430 core\n"
SHADED = HEAD + """uniform float shade; layout(location = 0) out vec4 result; void main() { result = vec4(gl_FragCoord.xy / 96.0, shade, 1.0); }"""
LAYERS = NEW + """layout(triangles) in; layout(triangle_strip, max_vertices = 9) out; void main() { for (int i = 0; i < 9; i++) { gl_Layer = i / 3;
gl_Position = gl_in[i % 3].gl_Position * vec4(1.0 - 0.2 * float(gl_Layer), 1.0, 1.0, 1.0); EmitVertex(); if (i % 3 == 2) EndPrimitive(); } }"""
COMPUTE = NEW + """layout(local_size_x = 8, local_size_y = 8) in; layout(rgba8, binding = 0) writeonly uniform image2D picture; uniform float shade;
layout(std430, binding = 1) buffer Sums { uint sums[]; }; layout(std430, binding = 2) readonly buffer Keys { uint keys[]; };
void main() { ivec2 p = ivec2(gl_GlobalInvocationID.xy); imageStore(picture, p, vec4(vec2(p) / 96.0, shade, 1.0));
if (p.y == 0) sums[p.x] = keys[p.x % 4] * uint(p.x); }"""


def compiled(*texts: str, kinds: tuple[int, ...] = (0x8B31, 0x8B30, 0x8DD9)) -> int:
    program = gl.glCreateProgram()
    for kind, text in zip(kinds, texts):
        shader, source = gl.glCreateShader(kind), ctypes.c_char_p(text.encode())
        gl.glShaderSource(shader, 1, ctypes.byref(source), None)
        gl.glCompileShader(shader)
        gl.glAttachShader(program, shader)
    gl.glLinkProgram(program)
    gl.glUseProgram(program)
    gl.glUniformMatrix4fv(gl.glGetUniformLocation(program, b"place"), 1, 0, (ctypes.c_float * 16)(*(at % 5 == 0 for at in range(16))))
    return program


def made(function: str) -> int:
    name = ctypes.c_uint()
    getattr(gl, function)(1, ctypes.byref(name))
    return name.value


def buffer(kind: int, data: Any) -> int:
    name = made("glGenBuffers")
    gl.glBindBuffer(kind, name)
    gl.glBufferData(kind, ctypes.c_size_t(ctypes.sizeof(data)), data, 0x88E4)
    return name


def texture(kind: int, storage: str, *sizes: int, wrap: int = CLAMP) -> int:
    name = made("glGenTextures")
    gl.glBindTexture(kind, name)
    getattr(gl, storage)(kind, *sizes)
    for parameter, value in ((0x2801, 0x2601), (0x2800, 0x2601), (0x2802, wrap), (0x2803, wrap)) if kind != SAMPLES else ():
        gl.glTexParameteri(kind, parameter, value)
    return name


def target(depth: bool, form: int = RGBA8, wrap: int = CLAMP) -> tuple[int, int]:
    frame, colour = made("glGenFramebuffers"), texture(TEXTURE_2D, "glTexStorage2D", 1, form, SIDE, SIDE, wrap=wrap)
    gl.glBindFramebuffer(FRAMEBUFFER, frame)
    gl.glFramebufferTexture2D(FRAMEBUFFER, COLOUR, TEXTURE_2D, colour, 0)
    if depth:
        gl.glFramebufferTexture2D(FRAMEBUFFER, DEPTH, TEXTURE_2D, texture(TEXTURE_2D, "glTexStorage2D", 1, 0x8CAC, SIDE, SIDE), 0)
    return frame, colour


def use(program: int, frame: int, read: int = 0, side: int = SIDE, **uniforms: float) -> None:
    gl.glBindFramebuffer(FRAMEBUFFER, frame)
    gl.glViewport(0, 0, side, side)
    gl.glUseProgram(program)
    gl.glBindTexture(TEXTURE_2D, read)
    for name, value in uniforms.items():
        gl.glUniform1fv(gl.glGetUniformLocation(program, name.encode()), 1, (ctypes.c_float * 1)(value))


def switch(*states: int, on: bool = False) -> None:
    for state in states:
        (gl.glEnable if on else gl.glDisable)(state)


class Scene:
    """What draws a frame."""

    def __init__(self) -> None:
        flat, layer = gl.glFramebufferTexture2D, gl.glFramebufferTextureLayer
        self.solid, self.compute = compiled(SOLID, COLOURED), compiled(COMPUTE, kinds=(0x91B9,))
        shaded, layered = compiled(SOLID, SHADED), compiled(SOLID, SHADED, LAYERS)
        self.programs = [[compiled(WHOLE, text.replace("TURN", turn).replace("SHIFT", shift)) for text in (BLUR, TONE)] for turn, shift in (
            ("gl_FragCoord.xy", "0.0"), ("gl_FragCoord.xy", "1.0"), ("vec2(gl_FragCoord.x, 96.0 - gl_FragCoord.y)", "0.0"))]
        self.scene, self.again, self.stored, self.resolved = target(True), target(False), target(False), target(False)
        self.soft = {"": target(False), "format": target(False, 0x881A), "wrap": target(False, wrap=0x2901), "channels": target(False)}
        gl.glTexParameteri(TEXTURE_2D, 0x8E42, 0x1904)  # of the last one, red is read as green
        self.still = [texture(TEXTURE_2D, "glTexStorage2D", 2, RGBA8, 2, 2) for _ in range(2)]
        for name, level, value in ((name, level, 60 + 90 * level * at) for at, name in enumerate(self.still) for level in range(2)):
            gl.glBindTexture(TEXTURE_2D, name)
            gl.glTexParameteri(TEXTURE_2D, 0x2801, 0x2701)  # it has mips
            gl.glTexSubImage2D(TEXTURE_2D, level, 0, 0, 2 >> level, 2 >> level, 0x1908, 0x1401, bytes([value] * 16))
        samples = texture(SAMPLES, "glTexStorage2DMultisample", 4, RGBA8, SIDE, SIDE, 1)
        array, layers = (texture(ARRAY, "glTexStorage3D", 1, RGBA8, SIDE, SIDE, 3) for _ in range(2))
        mips, self.made_mips = (texture(TEXTURE_2D, "glTexStorage2D", 4, RGBA8, SIDE, SIDE) for _ in range(2))
        cube, volume = texture(CUBE, "glTexStorage2D", 1, RGBA8, SIDE, SIDE), texture(VOLUME, "glTexStorage3D", 1, RGBA8, SIDE, SIDE, 4)
        whole, view = texture(TEXTURE_2D, "glTexStorage2D", 1, RGBA8, SIDE, SIDE), made("glGenTextures")
        gl.glTextureView(view, TEXTURE_2D, whole, RGBA8, 0, 1, 0, 1)  # a second name of its memory
        # How parts are attached, the arguments for each, the program, and by how much a part is smaller than the one before.
        self.targets = [(made("glGenFramebuffers"), *how) for how in (
            (flat, [(SAMPLES, samples, 0)], shaded, 0), (layer, [(array, 0, at) for at in range(3)], shaded, 0),
            (gl.glFramebufferTexture, [(layers, 0)], layered, 0), (flat, [(0x8515 + face, cube, 0) for face in range(6)], shaded, 0),
            (flat, [(TEXTURE_2D, mips, mip) for mip in range(4)], shaded, 1), (flat, [(TEXTURE_2D, self.made_mips, 0)], shaded, 0),
            (layer, [(volume, 0, at) for at in range(4)], shaded, 0),
            (flat, [(TEXTURE_2D, name, 0) for name in (whole, view, whole)], shaded, 0))]
        block = (ctypes.c_float * 72)(1, 0, 0, 0, 1, 1, 1, 1)
        block[64:72] = 1, 0, 0, 0, 1, .5, 1, 1
        self.block = buffer(0x8A11, block)
        self.buffers = [buffer(STORAGE, (ctypes.c_uint * 96)(3, 5, 7, last)) for last in (0, 9, 11)]
        self.meshes = [(buffer(0x8892, (ctypes.c_float * 12)(-.8, -.7, .7, -.8, .1, top, -.5, .6, .4, .5, .6, -.4)),
                        buffer(0x8893, (ctypes.c_ushort * 6)(0, 1, 2, 3, *last))) for top, last in ((.8, (4, 5)), (.7, (5, 4)))]

    def frame(self, fault: str) -> None:
        use(self.solid, self.scene[0], self.still[fault == "levels"])
        switch(DEPTH_TEST, OFFSET, on=True)
        gl.glDepthFunc(0x204 if fault in ("depth", "parts") else 0x201)
        gl.glBlendFunc(1, 1)
        gl.glPolygonOffset(*((0.0, 0.5) if fault == "offset" else (0.5, 0.0)))
        if fault != "before":
            gl.glClearColor(0.1, 0.2, 0.3, 1.0)
        gl.glClearStencil(fault == "clear")
        gl.glClear(0x4500)
        gl.glBindBufferRange(0x8A11, 0, self.block, ctypes.c_size_t(256 if fault == "block" else 0), ctypes.c_size_t(32))
        if fault == "clear":
            gl.glClearBufferfv(0x1800, 0, (ctypes.c_float * 4)(0.1, 0.4, 0.3, 1.0))
        switch(*(state for name, state in (("blend", BLEND), ("cull", CULL_FACE), ("scissor", SCISSOR), ("discard", DISCARD)) if name == fault), on=True)
        gl.glScissor(0, 0, 50, SIDE)
        gl.glViewport(8 if fault == "viewport" else 0, 0, SIDE, SIDE)
        for kind, name in zip((0x8892, 0x8893), self.meshes[fault == "vertices"]):
            gl.glBindBuffer(kind, name)
        gl.glVertexAttribPointer(0, 2, 0x1406, 0, 0, None)
        gl.glEnableVertexAttribArray(0)
        for start in (0, 3) if fault == "parts" else (0,):
            gl.glDrawElements(4, 3 if fault == "parts" else 6, 0x1403, ctypes.c_void_p(2 * start))
        switch(DEPTH_TEST, CULL_FACE, OFFSET, SCISSOR, BLEND, DISCARD)
        if fault.startswith("cover"):
            self.cover(fault == "covered")
        blur, tone = self.programs[{"shader": 1, "rows": 2}.get(fault, 0)]
        soft = self.soft.get(fault, self.soft[""])
        gl.glBlendFuncSeparate(1, 1, 1, 0)
        for program, frame, read in ((blur, soft, self.scene), (tone, self.again, soft), (tone, (0, 0), soft)):
            if fault != "pass" or frame != self.again:
                switch(BLEND, on=fault == "alpha" and frame == soft)
                read = self.scene if fault == "read" and frame == self.again else read
                use(program, frame[0], read[1], radius=2.0, iTime=0.49 if fault == "clock" else 0.22, exposure=1.25 if fault == "uniform" else 1.0)
                gl.glDrawArrays(4, 0, 3)

    def cover(self, wrong: bool) -> None:
        """Targets of all kinds. The middle one of each kind's layers, mips or faces may be wrong."""
        switch(0x809E, on=wrong)  # alpha to coverage
        for frame, attach, places, program, smaller in self.targets:
            for at, place in enumerate(places):
                use(program, frame, side=SIDE >> at * smaller, shade=0.9 if wrong and at == len(places) // 2 else 0.1 * at)
                attach(FRAMEBUFFER, COLOUR, *place)
                gl.glClear(0x4000)
                gl.glDrawArrays(4, 0, 6)
        gl.glBindTexture(TEXTURE_2D, self.made_mips)
        gl.glGenerateMipmap(TEXTURE_2D)
        gl.glBindFramebuffer(0x8CA8, self.targets[0][0])
        gl.glBindFramebuffer(0x8CA9, self.resolved[0])
        gl.glBlitFramebuffer(0, 0, SIDE, SIDE, 0, 0, SIDE, SIDE, 0x4000, 0x2600)
        use(self.compute, self.again[0], shade=0.9 if wrong else 0.5)
        gl.glBindImageTexture(0, self.stored[1], 0, 0, 0, 0x88B9, RGBA8)
        for place, name in enumerate((self.buffers[0], self.buffers[2 if wrong else 1]), 1):
            gl.glBindBufferBase(STORAGE, place, name)
        gl.glDispatchCompute(12, 11 if wrong else 12, 1)
        gl.glMemoryBarrier(0xffffffff)
        gl.glUseProgram(self.solid)
        for draw in range(100):
            if draw % 50 == 0:
                gl.glPushDebugGroup(0x824A, 0, -1, b"second half" if draw else b"first half")
            switch(BLEND, on=wrong and draw == 37)
            gl.glDrawArrays(4, 0, 6)
            if draw % 50 == 49:
                gl.glPopDebugGroup()


def renderdoc() -> list[Any]:
    """Functions of RENDERDOC_API_1_0_0: file names, begin and end."""
    functions = ctypes.POINTER(ctypes.c_void_p)()
    assert ctypes.CDLL("librenderdoc.so").RENDERDOC_GetAPI(10000, ctypes.byref(functions)) == 1
    shapes = ((11, ctypes.c_char_p), (19, ctypes.c_void_p), (21, ctypes.c_void_p))
    return [ctypes.CFUNCTYPE(ctypes.c_uint, kind, ctypes.c_void_p)(functions[at]) for at, kind in shapes]


def main() -> None:
    gl.glClearColor.argtypes = [ctypes.c_float] * 4
    gl.glPolygonOffset.argtypes = [ctypes.c_float] * 2
    glfw.glfwCreateWindow.restype = ctypes.c_void_p
    glfw.glfwInit()
    for hint, value in ((0x22002, 4), (0x22003, 5), (0x22008, 0x32001), (0x21005, 0), (0x21006, 0)):  # no depth, no stencil
        glfw.glfwWindowHint(hint, value)
    window = ctypes.c_void_p(glfw.glfwCreateWindow(SIDE, SIDE, b"scene", None, None))
    glfw.glfwMakeContextCurrent(window)
    gl.glBindVertexArray(made("glGenVertexArrays"))
    gl.glClipControl(0x8CA1, 0x935F)  # depth of 0 to 1, as Vulkan's
    scene = Scene()
    scene.frame("cover")  # so that what a frame does not write is the same in all
    for fault in sys.argv[1:] or [""] * 1000:
        name, begin, end = renderdoc() if fault else [lambda *_: 1] * 3
        name(fault.encode(), None)
        gl.glFinish()
        gl.glClearColor(0.1, 0.4, 0.3, 1.0)
        begin(None, None)
        scene.frame(fault)
        gl.glFinish()
        assert end(None, None) == 1 and not gl.glGetError()
        if fault:
            os.rename(f"{fault}_capture.rdc", fault + ".rdc")
            scene.frame("cover")
        glfw.glfwSwapBuffers(window)
        glfw.glfwPollEvents()


main()
