"""Words of C23, C++20 and GLSL 4.60 and macros of <windows.h> as names in a spec: `keywords.py GENERATOR TEMPLATES FOLDER`. Each is
refused at its place, or the generated header compiles as C11 and C++20, and under <windows.h> where MinGW is installed. The
lists are those of ISO/IEC 9899:2024 6.4.1, ISO/IEC 14882:2020 [lex.key] and [lex.digraph], The OpenGL Shading Language 4.60.8,
3.6, and MinGW 10. Called by hostile_test.sh."""
import os
import re
import shutil
import subprocess
import sys

C23 = """alignas alignof auto bool break case char const constexpr continue default do double else enum extern false float for goto
if inline int long nullptr register restrict return short signed sizeof static static_assert struct switch thread_local true
typedef typeof typeof_unqual union unsigned void volatile while _Atomic _BitInt _Complex _Decimal128 _Decimal32 _Decimal64
_Generic _Imaginary _Noreturn _Alignas _Alignof _Bool _Static_assert _Thread_local"""
CPP20 = """alignas alignof asm auto bool break case catch char char8_t char16_t char32_t class concept const consteval constexpr
constinit const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast else enum explicit export
extern false float for friend goto if inline int long mutable namespace new noexcept nullptr operator private protected public
register reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch template this
thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t while and and_eq bitand
bitor compl not not_eq or or_eq xor xor_eq import module final override"""
GLSL = """const uniform buffer shared attribute varying coherent volatile restrict readonly writeonly atomic_uint layout centroid flat
smooth noperspective patch sample invariant precise break continue do for while switch case default if else subroutine in out inout
int void bool true false float double discard return lowp mediump highp precision struct common partition active asm class union
enum typedef template this resource goto inline noinline public static extern external interface long short half fixed unsigned
superp input output filter sizeof cast namespace using sampler samplerShadow subpassInput isubpassInput usubpassInput
subpassInputMS isubpassInputMS usubpassInputMS sampler3DRect"""
SHAPES = ["1D", "2D", "3D", "Cube", "2DRect", "1DArray", "2DArray", "CubeArray", "Buffer", "2DMS", "2DMSArray"]
WINDOWS = """cdecl environ errno far h_addr hyper interface near pascal s_addr small chx1 cmb16 ctl1 edt1 frm4 grp1 ico4 lst1 psh16 rad1
rct4 scr8 stc32"""  # macros of <windows.h>, forbidden as names of struct members
MACROS = "NULL offsetof size_t int8_t int32_t uint8_t uint32_t uint64_t linux unix static_assert noreturn INT32_MAX UINT8_C"


def words():
    glsl = GLSL.split()
    glsl += [p + t + n for t in ("vec",) for p in ("", "i", "u", "b", "d", "h", "f") for n in "234"]
    glsl += [p + "mat" + n for p in ("", "d") for n in "2 3 4 2x2 2x3 2x4 3x2 3x3 3x4 4x2 4x3 4x4".split()]
    glsl += [p + k + s for p in ("", "i", "u") for k in ("sampler", "image", "texture") for s in SHAPES]
    glsl += ["sampler" + s + "Shadow" for s in ("1D", "2D", "2DRect", "1DArray", "2DArray", "Cube", "CubeArray")]
    return sorted(set(C23.split() + CPP20.split() + glsl + MACROS.split() + WINDOWS.split()))


BODY = "void main() { picture_store(ivec2(invocation().xy), vec4(1.0)); }\n"
HEAD = "pipeline: {pipeline}\n{params}\nstructs:\n  Row: {{own: float{fields}}}\n{structs}\nbuffers:\n  rows: {{of: Row, count: 1}}\n"
TAIL = "{buffers}\nimages:\n  picture: {{format: rgba8, size: frame}}\n{images}\npasses:\n{passes}output: {{display: picture}}\n"
PASS = "  - {{name: {0}, dispatch: picture, {1}: [picture], shader: keywords.glsl}}\n"


def spec(kind, names):
    parts = {part: "" for part in ("params", "structs", "fields", "buffers", "images")}
    parts.update(pipeline=f"plain_{kind}", passes=PASS.format("fill", "writes"))
    rows = "".join
    if kind == "param":
        parts["params"] = "params:\n" + rows(f"  {n}: {{value: 1.5, live: true}}\n" for n in names)
    elif kind == "struct":
        parts["structs"] = rows(f"  {n}: {{own: float}}\n" for n in names)
        parts["buffers"] = rows(f"  b{i}: {{of: {n}, count: 1}}\n" for i, n in enumerate(names))
    elif kind == "field":
        parts["fields"] = rows(f", {n}: float" for n in names)
    elif kind == "buffer":
        parts["buffers"] = rows(f"  {n}: {{of: Row, count: 1}}\n" for n in names)
    elif kind == "image":
        parts["images"] = rows(f"  {n}: {{format: rgba8, size: frame}}\n" for n in names)
    elif kind == "pass":
        parts["passes"] += rows(PASS.format(n, "updates") for n in names)
    else:
        parts["pipeline"] = names[0]
    return (HEAD + TAIL).format(**parts)


def generate(gen, templates, folder, kind, names):
    with open(f"{folder}/{kind}.yaml", "w", encoding="utf-8") as file:
        file.write(spec(kind, names))
    return subprocess.run([gen, f"{folder}/{kind}.yaml", "--templates", templates, "-o", f"{folder}/{kind}"],
                          capture_output=True, text=True, check=False)


def compiles(folder, kinds, names):
    """One source with the headers of these names, each kind's in a folder of its own."""
    source = f"{folder}/use.{{}}"
    good = True
    compilers = [("gcc", "c", "c11"), ("g++", "cpp", "c++20")]  # C17 has C11's words, C++17 has some of C++20's
    if kinds != ["pipeline"] and shutil.which("x86_64-w64-mingw32-gcc"):
        compilers.append(("x86_64-w64-mingw32-gcc", "c", "c11"))
    for compiler, suffix, standard in compilers:
        path = source.format(suffix)
        with open(path, "w", encoding="utf-8") as file:
            file.write("#ifdef _WIN32\n#include <windows.h>\n#endif\n")
            file.writelines(f'#include "{name}.h"\n' for name in names)
            file.write("int main(void) { return 0; }\n")
        run = subprocess.run([compiler, f"-std={standard}", "-Wall", "-Werror", "-fsyntax-only", "-Itemplates/c",
                              *(f"-I{folder}/{kind}" for kind in kinds), path],
                             capture_output=True, text=True, check=False)
        if run.returncode:
            print(f"{kinds}, {standard}: {run.stderr[:2000]}")
            good = False
    return good


def main():
    gen, templates, folder = sys.argv[1:]
    with open(f"{folder}/keywords.glsl", "w", encoding="utf-8") as file:
        file.write(BODY)
    good = True
    kinds = ["param", "struct", "field", "buffer", "image", "pass"]
    for kind in kinds:
        first = generate(gen, templates, folder, kind, words())
        refused = set(re.findall(r"error: `(\w+)`", first.stderr))
        left = [word for word in words() if word not in refused]
        if first.returncode != 1 or len(refused) < 200:
            print(f"{kind}: only {len(refused)} words are refused\n{first.stderr[:2000]}")
            good = False
        if kind in ("param", "field") and not set(WINDOWS.split()) <= refused:
            print(f"{kind}: {set(WINDOWS.split()) - refused} are macros of <windows.h>")
            good = False
        second = generate(gen, templates, folder, kind, left)
        if second.returncode:
            print(f"{kind}: {second.stderr[:2000]}")
        good &= second.returncode == 0
        print(f"{kind}: {len(refused)} refused, {' '.join(left)}")
    good = good and compiles(folder, kinds, [f"plain_{kind}" for kind in kinds])
    made = []
    for word in sorted(set(words()) - set(WINDOWS.split())):
        run = generate(gen, templates, folder, "pipeline", [word])
        if run.returncode and f"error: `{word}`" not in run.stderr:
            print(run.stderr[:1000])
            good = False
        elif not run.returncode:
            made.append(word)
    return 0 if good and made and compiles(folder, ["pipeline"], made) else 1


sys.exit(main())
