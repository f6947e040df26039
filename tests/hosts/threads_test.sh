#!/usr/bin/env bash
# Runs the Vulkan renderer of tests/hosts/examples under ThreadSanitizer, which checks the renderer and the runtime. Three threads
# open, record and close pipelines, and further threads compile the passes. The C++ renderer also writes inputs and takes resources on
# two threads. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit
gen=$build/gen
fixed=() # newer kernels place memory where ThreadSanitizer does not expect it
setarch -R true 2>"$work/output" && fixed=(setarch -R)

flags=(-fsanitize=thread -O1 -g -Wall -Wextra -Werror -I. -Itemplates/c -Iruntime_vk -Iscenes "-I$gen/ssvp" "-I$gen/rsm" "-I$work")
compile() { # folder source...: an object of each
    local folder=$work/$1 source
    shift
    mkdir -p "$folder"
    for source in "$@"; do
        cc -std=c11 -D_GNU_SOURCE "${flags[@]}" -c "$source" -o "$folder/$(basename "$source" .c).o" || return
    done
}
build_host() {
    compile both tests/hosts/examples/renderer_vk.c templates/c/{front,history}.c \
        runtime_vk/{device,errors,frame,host,panel,program,resources,verbs}.c &&
        compile host tests/hosts/examples/host_vk.c "$gen"/{ssvp/ssvp,ssvp/ssvp_vk_shaders,rsm/rsm,rsm/rsm_vk_shaders}.c &&
        cc -fsanitize=thread "$work"/{both,host}/*.o "$build/library/libdiptych_scene.a" \
            -lvulkan -lpng -lassimp -lmeshoptimizer -lfyaml -lcjson -ldl -lstdc++ -lm -o "$work/threads"
}
build_inputs() {
    "$build/diptych-gen" tests/hosts/examples/lit.yaml -o "$work" && compile inputs "$work"/lit{,_vk_shaders}.c &&
        c++ -std=c++17 "${flags[@]}" tests/hosts/examples/host_inputs_vk.cpp "$work"/{both,inputs}/*.o -lvulkan -ldl -lm -o "$work/writer"
}
runs_in_silence() {
    TSAN_OPTIONS="suppressions='$root/tests/lib/threads.supp'" "${fixed[@]}" "$work/threads" scenes/cornell.yaml 76 46 3 "$work/ssvp.ppm" \
        "$work/rsm.ppm" "$work/second.ppm" && [ ! -s "$work/output" ] && cmp "$work/ssvp.ppm" "$work/second.ppm"
}
inputs_run_in_silence() {
    TSAN_OPTIONS="suppressions='$root/tests/lib/threads.supp'" "${fixed[@]}" "$work/writer" && [ ! -s "$work/output" ]
}

echo 'int main(void) { return 0; }' >"$work/nothing.c"
if cc -fsanitize=thread "$work/nothing.c" -o "$work/nothing" 2>"$work/output" && "${fixed[@]}" "$work/nothing" 2>>"$work/output"; then
    check "a threaded renderer builds with ThreadSanitizer" build_host
    check "... opens, records and closes three views at once without a data race" runs_in_silence
    check "a C++ renderer builds with it" build_inputs
    check "... writes inputs and records two views at once without a data race" inputs_run_in_silence
else
    skip "a threaded renderer has no data race" "ThreadSanitizer does not run here"
fi
finish
