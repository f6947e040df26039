#!/bin/sh
# What the action and GitLab's job run: compare.sh FOLDER ARGUMENTS... of `diptych compare`.
# Leaves FOLDER/page, FOLDER/compare.xml and FOLDER/compare.json, prints a comment in Markdown, and has compare's exit status.
set -u
folder=${1:?a folder for the results}
shift
mkdir -p "$folder" || exit 2
diptych compare "$@" --html "$folder/page" --junit "$folder/compare.xml" --json "$folder/compare.json" >"$folder/table.txt" 2>"$folder/messages.txt"
status=$?
case $status in
0) echo "### diptych: all agree" ;;
1) echo "### diptych: a difference" ;;
*) echo "### diptych: could not compare" ;;
esac
echo
# what is said below the tables, each line an item; Markdown's own characters are shown as they are
{ grep -E '^(why:|or  |grown:|guilty|first pass|pass |no pass|all |.* is not repeatable|[^ ]+ against )' "$folder/table.txt"
    grep -E 'error:' "$folder/messages.txt"; } | grep -v '^pass  ' | sed 's/[][\\`*_<>#|]/\\&/g; s/^/- /'
if [ "$status" != 0 ]; then
    printf '\n<details><summary>table</summary>\n\n'
    sed 's/^/    /' "$folder/table.txt" "$folder/messages.txt"
    printf '\n</details>\n'
fi
exit "$status"
