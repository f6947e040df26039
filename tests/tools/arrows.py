"""Prints every #include that runs against the order of folders, as `FILE:LINE: error: ...`, and fails on one.

Called by `ninja check`, in the project's folder, with the C and C++ files to read."""
import os
import re
import sys

# A room of the generator or of the application may include itself and all rooms of the steps before its own.
GEN = [["model"], ["read"], ["check"], ["plan"], ["glsl"], ["spirv"], ["lower"], ["print"]]
APP = [["console"], ["picture"], ["result"], ["theirs", "import"], ["spec"], ["run"], ["compare", "play", "truth"], ["measure"], ["view", "bundle"]]
# A folder may include itself and these.
BELOW = {
    "templates": [],
    "base": ["templates"],
    "scenes": ["templates", "base"],
    "runtime_gl": ["templates"],
    "runtime_vk": ["templates"],
}


def add_rooms(folder, steps, below):
    for step in steps:
        BELOW.update({f"{folder}/{room}": list(below) for room in step})
        below += [f"{folder}/{room}" for room in step]
    BELOW[folder] = below


add_rooms("gen", GEN, ["templates", "base", "scenes"])  # and gen/main.c, load.c
add_rooms("app", APP, ["templates", "base", "scenes", "runtime_gl", "runtime_vk", "gen"] + [room for room in BELOW if room.startswith("gen/")])
BELOW["tests"] = list(BELOW)
SEARCHED = ["", "app/", "gen/", "templates/c/"]  # the compiler's include folders, searched after the file's own folder
WITHOUT_GRAPHICS = ["templates", "base", "scenes", "gen"]
GRAPHICS = re.compile(r"(vulkan|glad|GL|GLES\d*|EGL|KHR|GLFW)/|imgui")


def place(path):
    folders = path.split("/")[:-1]
    return "/".join(folders[:2]) if folders[0] in ("app", "gen") else folders[0]


def wrong(path, included):
    """Why this file may not include that name, or None."""
    own = place(path)
    if own.split("/")[0] in WITHOUT_GRAPHICS and GRAPHICS.match(included):
        return f"{own} includes no header of a graphics API"
    for folder in [os.path.dirname(path) + "/"] + SEARCHED:
        if os.path.exists(folder + included):
            other = place(os.path.normpath(folder + included))
            return None if other == own or other in BELOW[own] else f"{own} must not depend on {other}"
    return None  # generated, or the system's


def main():
    found = 0
    for path in sys.argv[1:]:
        with open(path, encoding="utf-8") as file:
            for number, line in enumerate(file, 1):
                include = re.match(r'\s*#\s*include\s*["<]([^">]+)[">]', line)
                reason = include and wrong(path, include[1])
                if reason:
                    found += 1
                    print(f"{path}:{number}: error: {include[1]}: {reason}")
    return 1 if found else 0


sys.exit(main())
