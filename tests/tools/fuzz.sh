#!/usr/bin/env bash
# Runs afl-fuzz on each kind of tests/tools/fuzz.c, FUZZ_SECONDS (60) for each: `fuzz.sh BUILD [KIND...]`. Seeds: tests/tools/fuzz/KIND, for
# specs and bodies also those of tests/. An input that crashes or hangs becomes tests/tools/fuzz/KIND/fail-HASH, which fuzz_test.sh tries
# from then on. Prints executions and failures; exit status 1 when there were failures.
set -euo pipefail
cd "$(dirname "$0")/../.."
build=$1
shift
kinds=("$@")
[ $# -gt 0 ] || read -ra kinds <<<"${KINDS:-spec body scene input evidence cache preset module}"
out=$build/found
failures=0
export AFL_SKIP_CPUFREQ=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_NO_UI=1 AFL_NO_AFFINITY=1
# A sanitizer's report aborts. ASan leaves SIGSEGV alone: a library's crash in a child is a signal, which the parent reports.
export ASAN_OPTIONS=abort_on_error=1:detect_leaks=0:symbolize=0:allocator_may_return_null=1:handle_segv=0 UBSAN_OPTIONS=abort_on_error=1

seeds() { # kind
    local seeds=$build/seeds/$1
    rm -rf "$seeds"
    mkdir -p "$seeds" "tests/tools/fuzz/$1"
    find "tests/tools/fuzz/$1" -type f ! -name 'fail-*' -exec cp -t "$seeds" {} +
    case $1 in
    spec) cp tests/specs/*.yaml tests/bad/*.yaml "$seeds" ;;
    body) cp tests/specs/*.glsl "$seeds" ;;
    esac
    echo "$seeds"
}

fuzz() { # kind
    afl-fuzz -V "${FUZZ_SECONDS:-60}" -t 10000+ -m none -i "$(seeds "$1")" -o "$out/$1" \
        -- "$build/tests/fuzz" "$1" @@ >"$out/$1.log" 2>&1
}

keep() { # kind: keeps inputs that also fail alone; at most eight, as they often have one cause
    local file status
    for file in "$out/$1"/default/crashes/id* "$out/$1"/default/hangs/id*; do
        [ -e "$file" ] || continue
        status=0
        { (ulimit -t 30 && exec timeout 600 "$build/tests/fuzz" "$1" "$file") || status=$?; } >"$out/said" 2>&1
        [ "$status" -gt 1 ] || continue
        failures=$((failures + 1))
        [ "$failures" -gt $((before + 8)) ] || cp "$file" "tests/tools/fuzz/$1/fail-$(sha256sum "$file" | cut -c 1-12)"
    done
}

rm -rf "$out"
mkdir -p "$out"
for kind in "${kinds[@]}"; do
    fuzz "$kind" &
done
wait # a kind that could not run has no fuzzer_stats
printf '%-10s %12s %9s\n' kind executions failures
for kind in "${kinds[@]}"; do
    before=$failures
    [ -e "$out/$kind/default/fuzzer_stats" ] || { tail -n 20 "$out/$kind.log"; exit 2; }
    keep "$kind"
    printf '%-10s %12s %9s\n' "$kind" "$(sed -n 's/^execs_done *: //p' "$out/$kind/default/fuzzer_stats")" $((failures - before))
done
[ "$failures" = 0 ]
