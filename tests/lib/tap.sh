# shellcheck shell=bash
# TAP for the shell tests. `check DESCRIPTION COMMAND...` runs a command and expects success; `check_status N ...` expects exit
# status N. A failed check prints the command's output. `finish` ends the TAP and the script. Sourced by tests/*_test.sh.
set -u
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(realpath "${DIPTYCH_BUILD:-$root/build}")
diptych=$build/diptych
planted=$build/diptych-planted # the same with --fault, --poison and --drop-...: see plant.c
tap_count=0
tap_failed=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

tap_result() { # outcome description
    tap_count=$((tap_count + 1))
    if [ "$1" = 0 ]; then
        echo "ok $tap_count - $2"
    else
        tap_failed=$((tap_failed + 1))
        echo "not ok $tap_count - $2"
        sed 's/^/# /' "$work/output" | tail -n 30
    fi
}

check_status() { # status description command...
    local want=$1 description=$2 got
    shift 2
    "$@" >"$work/output" 2>&1 </dev/null
    got=$?
    [ "$got" = "$want" ] || echo "exit status $got, expected $want" >>"$work/output"
    [ "$got" = "$want" ]
    tap_result $? "$description"
}

check() { # description command...
    local description=$1
    shift
    check_status 0 "$description" "$@"
}

# Limits of processor time, for each process; on a busy machine the time on the wall says nothing. After twenty times as long, what
# waits for something that does not come is ended, too.
limited() { # seconds command...: no shell function
    local seconds=$1
    shift
    (ulimit -t "$seconds" && exec timeout $((20 * seconds)) "$@")
}

wait_until() { # command...: tries every 0.1 s whether it holds, for ten minutes, or half a minute once a check has failed
    local tries
    for ((tries = tap_failed ? 300 : 6000; tries > 0; tries--)); do
        "$@" && return
        sleep 0.1
    done
    return 1
}

json_holds() { # file expression, in Python, of the document d
    /usr/bin/python3 -c 'import json, sys; d = json.load(open(sys.argv[1])); sys.exit(not eval(sys.argv[2]))' "$@"
}

reads_well() { # description page: nothing cut, contrast by WCAG AA, keys, a verdict on the screen; light and dark
    if command -v chromium >/dev/null; then
        check "$1" /usr/bin/python3 -B "$root/tests/app/pages.py" "$2" light dark
    else
        skip "$1" "chromium is not installed"
    fi
}

skip() { # description reason
    tap_count=$((tap_count + 1))
    echo "ok $tap_count - $1 # SKIP $2"
}

finish() {
    echo "1..$tap_count"
    [ "$tap_failed" = 0 ]
    exit
}

# Each test of these files becomes a line; without pytest all are skipped.
run_pytest() { # file...
    local outcome name status
    if ! /usr/bin/python3 -c 'import numpy, pytest' 2>"$work/output"; then
        skip "tests in Python" "needs python3-numpy and python3-pytest"
        return
    fi
    (cd "$work" && DIPTYCH_BUILD=$build PYTHONPATH=$root/app/python /usr/bin/python3 -B -m pytest -p no:cacheprovider \
        -W error -rA --tb=short "$@") >"$work/output" 2>&1
    status=$?
    while read -r outcome name _; do
        [ "$outcome" = PASSED ]
        tap_result $? "${name#*::}"
    done < <(sed -n '/short test summary info/,$p' "$work/output" | grep -E '^(PASSED|FAILED|ERROR) ')
    [ $status = 0 ]
    tap_result $? "pytest passed them all"
}
