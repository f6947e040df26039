"""For cost_test.sh: `cost.py holds FILE STATEMENT...`: Python about the JSON of `cost` as `c`; `cost.py kept DIPTYCH GPUS SPEC...`: a line for
each stage of these pipelines, with what the compiler says for each chip."""
import json
import math
import subprocess
import sys
import tempfile

KEPT = ["vgprs", "waves", "spills", "code", "cycles"]


def stage(c, gpu, name, which):
    """One stage of one pass."""
    passes = next(g for g in c["gpus"] if g["gpu"] == gpu)["passes"]
    return next(s for s in next(p for p in passes if p["pass"] == name)["stages"] if s["stage"] == which)


def holds(path, statements):
    with open(path, encoding="utf-8") as file:
        c = json.load(file)
    by_pass = {(g["gpu"], p["pass"]): p for g in c["gpus"] for p in g["passes"]}
    for statement in statements:
        assert eval(statement, {"c": c, "p": by_pass, "ceil": math.ceil, "stage": lambda *a: stage(c, *a)}), statement


def figures(c, gpu, name, which):
    return " ".join(str(int(stage(c, gpu, name, which)[number])) for number in KEPT)


def kept(diptych, gpus, specs):
    for spec in specs:
        with tempfile.TemporaryDirectory() as folder:
            path = folder + "/cost.json"
            subprocess.run([diptych, "cost", "--spec", spec, "--gpu", gpus, "--json", path], check=True, stdout=subprocess.DEVNULL)
            with open(path, encoding="utf-8") as file:
                c = json.load(file)
        for each in c["gpus"][0]["passes"]:
            for s in each["stages"]:
                print(c["pipeline"], each["pass"], s["stage"], *(f"| {g['gpu']} {figures(c, g['gpu'], each['pass'], s['stage'])}" for g in c["gpus"]))


if sys.argv[1] == "holds":
    holds(sys.argv[2], sys.argv[3:])
else:
    kept(sys.argv[2], sys.argv[3], sys.argv[4:])
