"""Runs clang-tidy on every file that has changed since it passed: `ninja -t compdb cc program | tidy.py STAMPS VERSION`.

Of a file that is compiled several times the first counts. The output is newer than the file's stamp, in the folder STAMPS, once
ninja has compiled the file again, so headers count, too. Called by `ninja check`, after what it compiles."""
import concurrent.futures
import json
import os
import shlex
import shutil
import subprocess
import sys

# The analyzer's default of 225,000 states for one function is six times the time, for a few of them. Of 55 mistakes made on
# purpose it finds 30 with 50,000 states and 29 with these, and of that one the compiler warns.
LIMITS = ["-Xclang", "-analyzer-config", "-Xclang", "max-nodes=30000"]


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
    words = words[: words.index(entry["file"])]  # libraries come behind it
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
    print(run.stdout + run.stderr, flush=True)  # stderr counts what was left out
    return False


def main():
    if not shutil.which(TIDY):
        print(f"skipped: version: needs {TIDY}")
        return 0
    entries = {}
    for entry in json.load(sys.stdin):
        if not entry["output"].endswith(".so"):  # libc's own functions, declared anew
            entries.setdefault(entry["file"], entry)
    due = [e for file, e in entries.items() if not file.startswith("build/") and is_due(e)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        good = list(pool.map(check, due))
    print(f"clang-tidy: {len(due)} files checked, {good.count(False)} with errors")
    return 0 if all(good) else 1


sys.exit(main())
