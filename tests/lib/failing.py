"""Makes the N-th call of malloc, open, read, write, rename... fail in a command: `failing.py LIBRARY SAMPLES OUT -- COMMAND`.
OUT is the folder or file that the command writes. Each run must end with status 0 and the right output, or with another status,
a message and the previous output. OLD has the options for that previous output. No run may crash or hang. With FOREIGN=1,
crashes and hangs in libraries that are not built here are only counted, and so are failures that a driver does not report.
With KILL=1 the call kills the process instead: the next run must succeed and leave no temporary file.
SAMPLES: numbers N to try for each kind of call, spread evenly; 0: all. Called by hostile_test.sh."""
import collections
import hashlib
import os
import re
import resource
import shutil
import signal
import subprocess
import sys

SECONDS = 60  # of processor time; a command that waits hangs after 20 times as long
HANGS = 1000
KINDS = os.environ.get("KINDS", "malloc calloc realloc open read write rename mmap").split()


def content(path):
    """Hashes of all files by name; empty without a file."""
    if os.path.isfile(path):
        return {"": hashlib.sha256(open(path, "rb").read()).hexdigest()}
    found = {}
    for folder, _, names in os.walk(path):
        for name in names:
            full = os.path.join(folder, name)
            found[os.path.relpath(full, path)] = hashlib.sha256(open(full, "rb").read()).hexdigest()
    return found


def remove(path):
    if os.path.isdir(path):
        shutil.rmtree(path)
    elif os.path.exists(path):
        os.remove(path)


def run(library, command, **more):
    environment = dict(os.environ, LD_PRELOAD=library, **more)

    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 5))
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
                          preexec_fn=limit) as process:
        try:
            out, err = process.communicate(timeout=20 * SECONDS)
            hangs = process.returncode in (-signal.SIGXCPU, -signal.SIGKILL) and "FAIL_KILL" not in more
            return subprocess.CompletedProcess(command, HANGS if hangs else process.returncode, out, err)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGABRT)  # prints the stack
            out, err = process.communicate()
            return subprocess.CompletedProcess(command, HANGS, out, err)


def foreign_library(result, command):
    """Name of the foreign library in which a run crashed or hung, or of the driver that hid a failed call; else false."""
    stopped = re.search("^stopped in (/.+)$", result.stderr, re.M)
    failed = re.search("^failed in (/.*/(dri/|libvulkan_|libLLVM|libgallium).*)$", result.stderr, re.M)
    found = failed if result.returncode == 0 else stopped
    beside = os.path.dirname(os.path.realpath(command[0]))
    return found and not os.path.realpath(found[1]).startswith(beside) and os.path.basename(found[1])


def judge(result, out, right, old):
    """The error of a run, or None."""
    if result.returncode == HANGS:
        return "it hangs"
    if result.returncode < 0:
        return f"signal {-result.returncode}"
    now = content(out)
    if result.returncode == 0:
        return None if now == right else "status 0, but the output is wrong"
    if not re.sub("^failed in .*$", "", result.stderr, flags=re.M).strip():
        return f"status {result.returncode} without a message"
    return None if now == old else f"a failed run leaves {sorted(name for name in set(now) | set(old) if now.get(name) != old.get(name))}"


def judge_killed(library, command, out, right):
    again = run(library, command)
    if again.returncode != 0:
        return f"the next run fails: {again.stderr[-300:]}"
    return None if content(out) == right else f"the next run leaves {sorted(set(content(out)) - set(right))}"


def main():
    library, samples, out = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    command = sys.argv[sys.argv.index("--") + 1:]
    kills = "KILL" in os.environ
    counts = out + ".counts"
    remove(out)
    first = run(library, command, FAIL_COUNT=counts)
    right = content(out)
    if first.returncode or not right:
        sys.exit(f"the command itself fails: {first.stderr}")
    before = out + ".before"
    remove(before)
    if "OLD" in os.environ:
        remove(out)
        run(library, command + os.environ["OLD"].split())
        os.rename(out, before)
    old = content(before)
    totals = {name: int(number) for name, number in (line.split() for line in open(counts))}
    tried, wrong, foreign = 0, 0, collections.Counter()
    for kind in KINDS:
        total = totals[kind]
        step = 1 if not samples else max(1, -(-total // samples))
        for number in range(1, total + 1, step):
            remove(out)
            if old:
                (shutil.copytree if os.path.isdir(before) else shutil.copy)(before, out)
            more = {"FAIL_KILL": "1"} if kills else {}
            result = run(library, command, FAIL_CALL=f"{kind}:{number}", **more)
            problem = judge_killed(library, command, out, right) if kills else judge(result, out, right, old)
            tried += 1
            culprit = problem and "FOREIGN" in os.environ and foreign_library(result, command)
            if culprit:
                foreign[f"{culprit}: {problem}"] += 1
            elif problem:
                wrong += 1
                print(f"{kind} {number} of {total}: {problem[:300]}: {result.stderr[-6000:]}", flush=True)
    print(f"{tried} runs of {' '.join(os.path.basename(word) for word in command[:2])}, {wrong} wrong; "
          f"in libraries: {dict(foreign) or 'nothing'}")
    sys.exit(wrong > 0)


main()
