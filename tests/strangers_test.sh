#!/usr/bin/env bash
# Drivers of different makers: passes that compute are exact on equal inputs; what scene draws leave differs at edges alone. TAP.
. "$(dirname "$0")/tap.sh"
. "$root/tests/drivers.sh"
cd "$root" || exit 1
edges=(compare --scene scenes/cornell.yaml --spec tests/specs/edges.yaml --size 160x90)
home=vk@llvmpipe

check "one maker: the contract \`raster\` changes nothing" sh -c '"$@" | grep -c " equal  " | grep -qx 4' - "$diptych" "${edges[@]}" --backend gl,$home
check_status 1 "... a draw that is missing is found" "$diptych" "${edges[@]}" --backend gl,$home --fault $home:draw:missing
if [ ${#strangers[@]} = 0 ]; then
    skip "drivers of different makers" "$no_strangers"
    finish
fi

# shellcheck disable=SC2317 # called through check
agrees() { # last line but one, arguments...: exit status 0, and what is told of edges
    local want=$1
    shift
    "$diptych" compare "$@" >"$work/table" && grep -E "$want" "$work/table" && tail -n 1 "$work/table" | grep -q 'agree$'
}

for driver in "${strangers[@]}"; do
    check "$driver: texels differ at edges, what is computed from them is exact" agrees \
        '^on equal inputs [1-9][0-9]* of 43200 drawn texels differ, at edges within the contract$' "${edges[@]:1}" \
        --backend "$home,$driver"
    check "... and against OpenGL" agrees '^on equal inputs' "${edges[@]:1}" --backend "gl,$driver"
    check_status 1 "... a share of 0 allows none" "$diptych" "${edges[@]}" --backend "$home,$driver" \
        --set 'contracts.number={raster: 0}'
    check_status 1 "... a fault in what is computed is found" "$diptych" "${edges[@]}" --backend "$home,$driver" \
        --fault "$driver:count:bit"
done
finish
