#!/usr/bin/env bash
# Every barrier of every pipeline is needed, and no barrier is missing. tests/runtime/barrier_audit.c drops each barrier in turn; a layout
# change also runs without its wait. The validation layers must report the missing barrier; where the layers are known to be
# silent, a model of the specification must. The counts are printed as comments. SEED draws how many bounces
# ssvp also has. Long: all, and more frame sizes.
. "$(dirname "$0")/../lib/tap.sh"
specs=$root/tests/specs
tiny=(--set first_vpls=16 --set second_vpls=16 --set clusters=2 --set rsm_size=32 --set map_size=32)
# The C library keeps what a frame frees for the next one: a quarter less time for hundreds of frames.
export MALLOC_TRIM_THRESHOLD_=1000000000 MALLOC_MMAP_THRESHOLD_=1000000000
bounces=(--live "bounces=$((${SEED:-RANDOM} % 2))")
[ -z "${DIPTYCH_LONG:-}" ] || bounces=(--live bounces=1 --live bounces=0)

audit() { # description arguments...
    local description=$1
    shift
    check "$description: every barrier is missed when it is left out" "$build/barrier-audit" "$@"
    grep -hE '^(dropped|weakened|bits):' "$work/output" | sed 's/^/# /'
}

pipelines() { # size
    audit "ssvp at $1" "$root/templates/ssvp.yaml" "${tiny[@]}" "${bounces[@]}" --size "$1"
    audit "rsm at $1" "$root/templates/rsm.yaml" --set rsm_size=32 --live bounces=0 --size "$1"
    audit "features at $1" "$specs/features.yaml" --live blur=false --size "$1"
    audit "mips at $1" "$specs/mips.yaml" --live shrink=false --size "$1"
    audit "mips and layers in place at $1" "$specs/bloom.yaml" --size "$1"
    audit "draws at $1" "$specs/particles.yaml" --size "$1"
    audit "formats at $1" "$specs/formats.yaml" --size "$1"
    audit "culled draws at $1" "$specs/cull.yaml" --set room=400 --size "$1"
    audit "shapes at $1" "$specs/shapes.yaml" --size "$1"
    audit "atomics at $1" "$specs/atomics.yaml" --size "$1"
    audit "groups at $1" "$specs/groups.yaml" --size "$1"
    audit "layout at $1" "$specs/layouts.yaml" --size "$1"
    audit "kinds at $1" "$specs/kinds.yaml" --size "$1"
    audit "memory at $1" "$specs/memory.yaml" --size "$1"
}

pipelines 24x16
if [ -n "${DIPTYCH_LONG:-}" ]; then
    pipelines 1x1
    pipelines 17x9
    pipelines 97x65
fi

# The recorder sees only the functions of Vulkan that it intercepts. Of the commands left out here, vkCmdClearDepthStencilImage
# and vkCmdUpdateBuffer occur only in frames of a host.
check "every command that the runtime records is seen by the audit" \
    bash -c "for name in \$(grep -ohE 'vk\.?Cmd[A-Za-z0-9]+' '$root'/runtime_vk/*.c | tr -d . | sort -u); do
        case \$name in
        vkCmdBeginDebugUtilsLabelEXT | vkCmdEndDebugUtilsLabelEXT | vkCmdPushConstants | vkCmdResetQueryPool | vkCmdSetScissor | vkCmdSetViewport | vkCmdWriteTimestamp2 | \
            vkCmdClearDepthStencilImage | vkCmdUpdateBuffer) continue ;;
        esac
        grep -q \"^\(void\|VkResult\) \$name(\" '$root/tests/lib/tape.c' || { echo \"\$name\"; exit 1; }
    done"

# Dropped barriers under the program. The first of two frames is not observed: an observer waits after every pass.
render() { # arguments...
    "$planted" render --scene "$root/scenes/cornell.yaml" --spec "$specs/features.yaml" --size 24x16 --backend vk --frames 2 --debug \
        --timings "$work/timings.json" "$@"
}
check "without dropping validation is silent" render
check_status 1 "a dropped barrier fails a run with --debug" render --drop-barrier 7
check_status 1 "a dropped dependency fails it, too" render --drop-dependency 7
cp "$work/output" "$work/weakened"
check "... by what the layer says" grep -q "READ_AFTER_WRITE" "$work/weakened"
# What differs nowhere here is told as what would break elsewhere.
compare=("$planted" compare --scene "$root/scenes/cornell.yaml" --spec "$specs/features.yaml" --size 24x16 --backend "vk,gl" --debug
    --json "$work/told.json")
check "compare --debug finds all barriers" "${compare[@]}"
check_status 1 "... and tells one that is missing though both backends agree" "${compare[@]}" --drop-barrier 7
cp "$work/output" "$work/told"
is_told() {
    cat "$work/told"
    grep -qE "^elsewhere: (frame|keep): no barrier orders a read after a write of draw_arguments, on vk$" "$work/told" && # by layer
        grep -q "^all 20 resources of 12 passes agree$" "$work/told" &&
        json_holds "$work/told.json" '[e["kind"] for e in d["elsewhere"]] == ["barrier"]'
}
check "... by pass, resource and side, in the table and in JSON" is_told
# Here first.number reuses memory of rsm_triangle, second.number reuses that of first.number, and first.number is the smallest.
check "memory that changes hands through a smaller image is silent under validation" "$build/diptych" render --debug --backend vk \
    --scene "$root/scenes/cornell.yaml" --spec "$root/templates/ssvp.yaml" --size 37x23 --frames 3 --set rsm_size=64 \
    --set map_size=32 --set first_vpls=64 --set second_vpls=96 --set clusters=3 -o "$work/a.png"
finish
