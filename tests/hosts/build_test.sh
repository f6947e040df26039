#!/usr/bin/env bash
# The build makes only outputs of changed files. Runs on a copy of the tree and of its finished build, with all file times. So
# the test does not change the tree, nor disturb the ninja that runs this test. TAP.
. "$(dirname "$0")/../lib/tap.sh"
tree=$work/tree
export NINJA_STATUS="[%f/%t] "

mkdir "$tree"
(cd "$root" && for entry in *; do [ "$entry" = build ] || cp -a "$entry" "$tree/" || exit; done &&
    mkdir "$tree/build" && for entry in build/.ninja_* build/*; do
        case $entry in
        build/asan | build/barrier-audit | build/bundle | build/cache | build/check | build/demo | build/equal-inputs) ;;
        build/swiftshader | build/tests) ;;
        *) cp -a "$entry" "$tree/build/" || exit ;;
        esac
    done) || exit
cd "$tree" || exit

# Builds the program, and the pipelines as C, which only tests need.
# shellcheck disable=SC2120,SC2119 # called through check
ninja() { # option...
    command ninja all build/obj/pipelines.a "$@"
}

# The command runs from `least` to `most` edges, and all match the extended regular expression.
edges() { # least most pattern ninja-command...
    local least=$1 most=$2 pattern=$3 count
    shift 3
    "$@" >"$work/ran" || { cat "$work/ran" && return 1; }
    grep '^\[' "$work/ran" >"$work/edges"
    count=$(wc -l <"$work/edges")
    echo "$count edges, expected $least to $most; of other kinds:"
    ! grep -vE -- "$pattern" "$work/edges" && [ "$count" -ge "$least" ] && [ "$count" -le "$most" ]
}

nothing_to_do() {
    ninja | grep -F "ninja: no work to do."
}

older() { # file...: all older than the stamp
    local file
    for file in "$@"; do
        [ "$work/stamp" -nt "$file" ] || { echo "$file is new" && return 1; }
    done
}

check "the copy is built" ninja
check "a second time there is nothing to do" nothing_to_do

# A dry run lists more edges, as it cannot know which outputs will stay unchanged.
sleep 0.05
touch "$work/stamp"
sleep 0.05
touch templates/rsm.yaml
check "a touched spec concerns its pipeline" edges 1 6 'rsm|pipelines.a' ninja -n
check "... is generated again, and no more" edges 1 1 'GENERATE templates/rsm\.yaml' ninja
check "... as its files are what they were" older build/gen/rsm/rsm* build/obj/pipelines/rsm*.o
check "... and then there is nothing to do" nothing_to_do
for file in glsl yaml; do
    touch templates/shared/gbuffer.$file
    check "a touched gbuffer.$file concerns the pipelines that include it" \
        edges 7 7 'GENERATE templates/(rsm|ssvp|instant_radiosity|ssdo|deep|clustered|taa)\.yaml' ninja
done

sed -i 's/\(gather_radius: .*value: 0\.\)5/\125/' templates/rsm.yaml
check "another default of a live parameter changes C" edges 2 4 'rsm|pipelines.a' ninja
check "... and no shader" older build/gen/rsm/gl/* build/gen/rsm/vk/*
check "... and then there is nothing to do" nothing_to_do
sed -i 's/\(rsm_size: .*value: \)512/\1384/' templates/rsm.yaml
check "another value of a uniform parameter changes C, though it is a size" edges 2 6 'rsm|pipelines.a' ninja
check "... and no shader" older build/gen/rsm/gl/* build/gen/rsm/vk/*
echo 'int extra(void);' >app/console/extra.c
# shellcheck disable=SC2016 # the variable is ninja's
echo 'build $obj/app/extra.o: cc app/console/extra.c' >>app/build.ninja
check "a new source file is one line" edges 5 5 'build/obj/app[/.]|build/diptych|build/libdiptych_play' ninja
check "... and is linked" bash -c 'ar t build/obj/app.a | grep -Fx extra.o'
sed -i '/extra[.]o/d' app/build.ninja
check "without it ..." edges 4 4 'build/obj/app[/.]|build/diptych|build/libdiptych_play' ninja
check "... it is not linked" bash -c '! ar t build/obj/app.a | grep -Fx extra.o'
touch gen/plan/plan.h
check "a touched header concerns those that include it" \
    edges 3 140 'build/obj/gen[/.]|build/obj/app/build[/.]|build/diptych|build/libdiptych_play|GENERATE|build/obj/pipelines[/.]' ninja -n
check "... the planner among them" grep -F 'CC build/obj/gen/plan.o' "$work/edges"
finish
