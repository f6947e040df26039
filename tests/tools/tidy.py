"""Runs clang-tidy on every file that has changed since it passed: `ninja -t compdb cc program | tidy.py STAMPS VERSION`.

For a file that is compiled several times, only the first command counts. A file is due if its object is newer than its stamp
in the folder STAMPS, so changes of headers count, too. Called by `ninja check`, after the compilation."""
import concurrent.futures
import json
import os
import shlex
import shutil
import subprocess
import sys

# Limits the states per function, since a few functions take most of the time: 30,000 states take twice as long. Of 143
# deliberate mistakes that the compiler does not warn of (a check, a free or an initial value that is missing, a free twice), the
# analyzer finds the same 31 with 30,000 and with 10,000.
LIMITS = ["-Xclang", "-analyzer-config", "-Xclang", "max-nodes=10000"]


TIDY = f"clang-tidy-{sys.argv[2]}"


def stamp_of(entry):
    return f"{sys.argv[1]}/{entry['file']}.tidy"


def is_due(entry):
    def changed(path):
        return os.stat(path).st_mtime_ns

    stamp = stamp_of(entry)
    return not os.path.exists(stamp) or changed(stamp) < max(changed(entry["output"]), changed(".clang-tidy"))


def check(entry):
    words = shlex.split(entry["command"])[1:]
    words = words[: words.index(entry["file"])]  # libraries follow the file
    at = words.index("-MF")
    del words[at : at + 2]
    flags = [word for word in words if word not in ("-MMD", "-c")]
    run = subprocess.run(
        [TIDY, "--quiet", entry["file"], "--", *flags, *LIMITS], capture_output=True, text=True
    )
    if run.returncode == 0:
        os.makedirs(os.path.dirname(stamp_of(entry)), exist_ok=True)
        with open(stamp_of(entry), "w", encoding="utf-8"):
            pass
        return True
    print(run.stdout + run.stderr, flush=True)  # stderr has the number of hidden warnings
    return False


def main():
    if not shutil.which(TIDY):
        print(f"skipped: version: needs {TIDY}")
        return 0
    entries = {}
    for entry in json.load(sys.stdin):
        if not entry["output"].endswith(".so"):  # libraries to preload declare functions of libc again
            entries.setdefault(entry["file"], entry)
    due = [e for file, e in entries.items() if not file.startswith("build/") and is_due(e)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        good = list(pool.map(check, due))
    print(f"clang-tidy: {len(due)} files checked, {good.count(False)} with errors")
    return 0 if all(good) else 1


sys.exit(main())
