"""The runs of a folder. Each is a command of diptych that leaves NAME.VERB.json; Snakemake runs them, by the Snakefile beside this
module, and runs again what has changed. This module plans the runs and reads what they left, for grid.py and report.py."""
from __future__ import annotations

import dataclasses
import json
import math
import os
import re
import shlex
import shutil
import signal
import subprocess
import tempfile
from typing import Any, Iterable

from .console import Console, Failure, write

HERE = os.path.dirname(os.path.realpath(__file__))


@dataclasses.dataclass
class Scene:
    """A scene file; its folder has the results. `mesh` is None where it was not found: the scene is left out."""

    path: str
    name: str
    mesh: str | None

    @property
    def folder(self) -> str:
        return plain(self.name)


NO_SCENE = Scene("", "none", "")


@dataclasses.dataclass
class Run:
    """One command. `needs`: files of other runs, and absolute paths."""

    file: str
    needs: list[str]
    command: str
    part: str
    scene: Scene


def plain(text: str) -> str:
    """A word for file names that needs no quotes, neither for a shell nor for Snakemake."""
    return re.sub(r"[^\w.+@-]", "_", text, flags=re.ASCII)


def shipped(name: str, folder: str) -> str:
    """The path of a file that the user names: a bare word is one that came with diptych."""
    path = os.path.join(folder, name + ".yaml")
    return path if not re.search("[./]", name) and not os.path.isfile(name) and os.path.exists(path) else name


class Workflow:
    def __init__(self, console: Console, request: dict[str, Any]):
        self.console, self.request = console, request
        self.folder: str = os.path.abspath(request["output"])
        self.program: str = request["program"]
        self.sides: list[str] = request["sides"]
        self.templates: str = request["templates"]
        self.runs: dict[str, Run] = {}
        self.results: dict[str, Any] = {}
        self.spec = ""
        self.spec_files: list[str] = []
        self.size = ""
        self.meshes = request.get("scenes") or os.environ.get("DIPTYCH_SCENES")
        if self.meshes and not os.path.isdir(self.meshes):
            console.fail(f"--scenes {self.meshes}: No such file or directory")

    # ---- Preparing -------------------------------------------------------------------------------

    def needs_programs(self, modules: Iterable[str]) -> None:
        """Called first: a program that is missing must not show after hours."""
        if not shutil.which("snakemake"):
            self.console.fail("snakemake: cannot be started: No such file or directory; install the package snakemake")
        for module in modules:
            try:
                __import__(module)
            except ImportError as error:
                self.console.fail(f"{error}; install the package python3-{module}")

    def find_scenes(self, names: list[str], folder: str = "") -> list[Scene]:
        """Scene files, beside a folder where it is given; one at least must have its mesh."""
        import yaml  # type: ignore[import]

        scenes: list[Scene] = []
        for name in names:
            path = shipped(os.path.join(folder, name), os.path.join(self.templates, "../scenes"))
            path = os.path.realpath(path)
            word = os.path.splitext(os.path.basename(path))[0]
            with open(path, encoding="utf-8") as file:
                try:
                    mesh = str(yaml.safe_load(file)["mesh"])
                except (yaml.YAMLError, TypeError, KeyError):
                    mesh = os.path.basename(path)  # the runs tell what is wrong
            if any(other.folder == plain(word) for other in scenes) or plain(word) == "plots":
                self.console.fail(f'{path}: the {self.console.verb} cannot have a folder "{word}" for it; rename the file')
            places = [os.path.join(place, mesh) for place in (os.path.dirname(path), self.meshes or "") if place]
            scenes.append(Scene(path, word, next((place for place in places if os.path.exists(place)), None)))
            if not scenes[-1].mesh:
                self.console.warning(f"{path} is left out: its mesh was not found; --scenes or DIPTYCH_SCENES names its folder")
        if not any(scene.mesh for scene in scenes):
            self.console.fail(f"no scene is left for the {self.console.verb}; name one with --scene FILE")
        return scenes

    def check_spec(self, sets: list[str]) -> None:
        """Whether the spec takes these values, before hours of work; finds its files and the frame's size."""
        words = [self.program, "list", *self.spec_words(sets)]
        words += ["--size", self.request["size"]] if isinstance(self.request.get("size"), str) else []
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "told.json")
            status = subprocess.run([*words, "--json", path], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, check=False)
            if not os.path.exists(path):
                self.console.fail(f"{shlex.join(words)}: ended with status {status.returncode}")
            with open(path, encoding="utf-8") as file:
                told = json.load(file)
        self.console.errors += told["errors"]
        if status.returncode:
            raise Failure
        self.spec, self.spec_files = told["spec"], told["files"]
        self.size = f'{told["width"]}x{told["height"]}'

    def make_folder(self) -> None:
        """A new folder, an empty one, or one of the same verb."""
        if os.path.isdir(self.folder) and os.listdir(self.folder) and self.former().get("verb") != self.console.verb:
            self.console.fail(f"{self.request['output']}: holds files, but no {self.console.verb}; give another folder")
        os.makedirs(self.folder, exist_ok=True)

    def former(self) -> dict[str, Any]:
        """What was planned in the folder; nothing where nothing was."""
        try:
            with open(self.path("config.json"), encoding="utf-8") as file:
                config = json.load(file)
        except (OSError, ValueError):
            return {}
        return config if isinstance(config, dict) else {}

    # ---- Commands --------------------------------------------------------------------------------

    def path(self, file: str) -> str:
        return os.path.join(self.folder, file)

    def pattern(self, file: str) -> str:
        """Where the command takes a pattern of numbered files."""
        return self.folder.replace("%", "%%") + "/" + file

    def scene_words(self, scene: Scene) -> list[str]:
        meshes = ["--scenes", os.path.abspath(self.meshes)] if self.meshes else []
        return ["--scene", scene.path, *meshes] if scene.path else []

    def spec_words(self, sets: Iterable[str] = ()) -> list[str]:
        """--set of the command line comes last, and wins."""
        inputs = []
        for item in self.request.get("input", []):
            name, file = item.split("=", 1)
            inputs.append(f"{name}={os.path.abspath(file)}")
        spec = self.spec or shipped(str(self.request.get("spec", "ssvp")), self.templates)
        pairs = [("--set", text) for text in [*sets, *self.request.get("set", [])]] + [("--input", text) for text in inputs]
        return ["--spec", spec, *(word for pair in pairs for word in pair)]

    def option_words(self, *names: str) -> list[str]:
        """Options that are handed on as they were given."""
        words = []
        for name in names:
            value = self.request.get(name.replace("-", "_"))
            words += [f"--{name}"] if value is True else [f"--{name}", str(value)] if value else []
        return words

    def add(self, verb: str, name: str, words: list[str], scene: Scene, *, needs: Iterable[str] = (), rule: str = "", part: str = "",
            then: str = "") -> str:
        """Plans a run; returns its file, NAME.RULE.json."""
        file = f"{name}.{rule or verb}.json"
        if file in self.runs:
            self.console.fail(f"two runs would write {file}; give pictures and values different names")
        reads_spec = verb not in ("reference", "metrics", "flicker")
        inputs = [self.program, scene.path, scene.mesh, *needs]
        if reads_spec:
            inputs += [*self.spec_files, *(os.path.abspath(i.split("=", 1)[1]) for i in self.request.get("input", []))]
        for path in [self.folder, *filter(None, inputs)]:
            if re.search(r"[{}\n]", path):
                self.console.fail(f"{path}: a Snakefile cannot hold a path with a brace or a line break")
        command = shlex.join([self.program, verb, *words, "--json", self.path(file)]) + then
        self.runs[file] = Run(file, [need for need in inputs if need], command, part, scene)
        return file

    # ---- Running ---------------------------------------------------------------------------------

    def write(self) -> None:
        runs = {}
        for run in self.runs.values():
            pictures = [need.removesuffix("json") + "exr" for need in run.needs if re.search(r"\.(render|reference)\.json$", need)]
            runs[run.file] = {"command": run.command, "needs": run.needs + pictures}
        config = {"verb": self.console.verb, "request": self.request, "runs": runs}
        write(self.path("config.json"), json.dumps(config, indent=1))
        with open(os.path.join(HERE, "Snakefile"), encoding="utf-8") as file:
            write(self.path("Snakefile"), file.read())

    def run(self, jobs: int) -> None:
        """Runs what is not there. A run that fails is found by its result, and stops only those that need it."""
        profile = self.request.get("profile")
        words = ["snakemake", "--snakefile", self.path("Snakefile"), "--directory", self.folder, "--keep-going", "--nolock",
                 "--rerun-incomplete", "--scheduler", "greedy", "--quiet", "rules"]
        words += ["--profile", profile, *self.option_words("jobs")] if profile else ["--cores", str(jobs)]
        self.write()
        # in a group of its own, which a signal ends as a whole; a kill of this process reaches snakemake alone
        with subprocess.Popen(["setpriv", "--pdeathsig", "TERM", *words], stdin=subprocess.DEVNULL, stdout=2,
                              start_new_session=True) as process:
            try:
                process.wait()
            except BaseException:
                os.killpg(process.pid, signal.SIGTERM)
                process.wait()
                raise

    # ---- Results ---------------------------------------------------------------------------------

    def done(self, file: str) -> bool:
        """Whether there is a result that belongs to this plan: an old one may wait for a run that has failed."""
        return os.path.exists(self.path(file)) and all(self.done(need) for need in self.runs[file].needs if need in self.runs)

    def log(self, file: str) -> list[str]:
        try:
            with open(self.path(file.removesuffix(".json") + ".txt"), encoding="utf-8", errors="replace") as log:
                return log.read().splitlines()
        except OSError:
            return []

    def reason(self, file: str) -> str | None:
        """Why there is no result: the first error that the run, or one that it needs, has told. None: there is one."""
        if file not in self.runs or self.done(file):
            return None
        for need in self.runs[file].needs:
            reason = self.reason(need)
            if reason:
                return reason
        log = self.log(file)
        if not log:
            return f"{file}: has not been made yet"
        errors = [line for line in log if "error: " in line]
        return errors[0].removeprefix("diptych: error: ") if errors else f"{file}: was not made, see its .txt"

    def result(self, file: str) -> Any:
        """The JSON of a run; None where there is none."""
        if file not in self.results:
            self.results[file] = None
            if file in self.runs and self.done(file):
                with open(self.path(file), encoding="utf-8") as text:
                    self.results[file] = json.load(text)
        return self.results[file]

    def number(self, file: str, path: str) -> float:
        """A member a.b.c of a result; NaN where there is none."""
        value = self.result(file)
        for name in path.split("."):
            value = value.get(name) if isinstance(value, dict) else None
        return float(value) if isinstance(value, (int, float)) else math.nan

    def missing(self) -> list[str]:
        return [file for file in self.runs if not self.done(file)]

    def tell_missing(self) -> None:
        """An error for each run that has failed itself; of runs not yet done, the number alone."""
        missing = self.missing()
        for file in missing:
            if not self.request.get("collect") and all(self.done(n) for n in self.runs[file].needs if n in self.runs):
                self.console.error(f"{self.reason(file)}; there is no result of: {self.runs[file].command}")
        if missing and self.request.get("collect"):
            self.console.info(f"{len(missing)} of {len(self.runs)} runs have no result yet")
