#!/usr/bin/env bash
# The action and GitLab's job of templates/ci: their steps run in a clean folder, on a program with a tap. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$work" || exit 1
if ! /usr/bin/python3 -c 'import yaml' 2>"$work/output"; then
    skip "the action" "needs python3-yaml"
    finish
fi
cat >program.c <<'END'
#include "diptych_tap.h"
static int leave(const char *folder, const char *label, int over) {
    unsigned char texels[6][8][4] = {{{0}}};
    struct tap *tap = tap_open(folder, label, NULL);
    struct tap_texels image = {.format = "rgba8", .width = 8, .height = 6, .bytes = texels};
    for (int i = 0; i < 48; i++)
        texels[over ? 5 - i / 8 : i / 8][i % 8][i % 3] = (unsigned char)(40 + 4 * i);
    tap_image(tap, "light", "radiance", &image);
    return tap_close(tap);
}
int main(int argc, char **argv) {
    char gl[200], vk[200];
    snprintf(gl, sizeof gl, "%s/gl", argv[1]);
    snprintf(vk, sizeof vk, "%s/vk", argv[1]);
    mkdir(argv[1], 0777);
    return !leave(gl, "gl", 0) || !leave(vk, "vk", argc > 2);
}
END
mkdir bin
ln -s "$planted" bin/diptych
check "a program with a tap" cc -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror -I"$root/templates/c" program.c -o program

# Runs what a service would, without the service's own steps and apt: steps FILE FOLDER NAME=VALUE...
cat >steps.py <<'END'
import os, subprocess, sys, yaml
path, folder, *given = sys.argv[1:]
given = dict(text.split("=", 1) for text in given)
ci = os.path.dirname(path)
document = yaml.safe_load(open(path))
os.makedirs(folder)
env = {"PATH": os.environ["PATH"], "HOME": folder, "GITHUB_ACTION_PATH": ci}
if "runs" in document:
    inputs = {key: given.get(key, item.get("default")) for key, item in document["inputs"].items()}
    assert document["runs"]["using"] == "composite" and set(given) <= set(inputs)
    steps = []
    for step in document["runs"]["steps"]:
        if "apt-get" in step.get("run", "apt-get"):
            continue
        values = {key: inputs[text.removeprefix("${{ inputs.").removesuffix(" }}")] for key, text in step["env"].items()}
        if step.get("if") != "inputs.run != ''" or inputs["run"]:
            steps.append((["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]], values))
else:
    job = document["diptych"]
    lines = [line.replace("/usr/share/diptych/templates/ci", ci) for line in job["script"] if "apt-get" not in line]
    steps = [(["sh", "-c", line], {**job["variables"], **given}) for line in lines]
    assert len(steps) == 2
for command, values in steps:
    status = subprocess.run(command, cwd=folder, env={**env, **values}).returncode
    if status:
        sys.exit(status)
END
steps() { # file folder name=value...
    PATH=$work/bin:$PATH /usr/bin/python3 -B steps.py "$root/templates/ci/$1" "$work/$2" "${@:3}" | tee said
    return "${PIPESTATUS[0]}"
}
check_status 0 "the action, where both agree" steps action.yml agree run="$work/program out" compare="out/gl out/vk"
check "... says so" grep -qx '### diptych: all agree' agree/diptych-results/comment.md
check_status 1 "the action, where they differ" steps action.yml differ run="$work/program out over" compare="out/gl out/vk"
check "... names pass and reason on stdout" grep -q '^- why: radiance: equal (to a code) after a flip in y' said
check "... and keeps page and XML" grep -q 'failures="1"' differ/diptych-results/compare.xml
check "... of pictures" [ -e differ/diptych-results/page/00.light.radiance.difference.png ]
check_status 1 "a spec needs no program" steps action.yml spec compare="--spec '$root/tests/specs/contracts.yaml' --scene '$root/scenes/cornell.yaml' --size 17x9 --fault vk:paint:missing"
check "... and is explained as well" grep -q '^- guilty: pass paint' said
check_status 2 "a dump that is not there" steps action.yml none compare="out/gl out/vk"
check "... is told" grep -q '^- diptych: error: out/gl: cannot be listed' said
check_status 0 "GitLab's job" steps gitlab.yml gitlab RUN="$work/program out"
check_status 1 "... where they differ" steps gitlab.yml gitlab_differs RUN="$work/program out over"
check "... with the XML that it names" [ -s gitlab_differs/diptych-results/compare.xml ]
finish
