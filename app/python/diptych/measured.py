"""`compare --measure`: the table of noise, drift and difference of backends, and contracts that all runs keep. The C program
hands over the errors of all runs, row by row (app/result/measured.c)."""
from __future__ import annotations

import math
import re
from typing import Any

from .console import Console, printable, write

Json = dict[str, Any]
TITLES = {"noise": "noise of a side", "drift": "drift", "backends": "difference of backends"}
STEPS = [float(f"{digits}e{power}") for power in range(-20, 21) for digits in ("1", "1.5", "2", "3", "5", "7")]  # of "beyond"
FEW_ULP, SMALL_REL = 16, 0.01


# ---- The table -----------------------------------------------------------------------------------


def error_cells(errors: Json) -> str:
    if errors.get("missing"):
        return "  missing in a run"
    if errors["not_comparable"]:
        return "  NaN, Inf or other sizes"
    if not errors["differing"]:
        return "  none"
    return f"  {errors['differing']:10.0f}" + "".join(
        f"  {errors[key]:8.3g}" for key in ("median", "p95", "p99_9", "largest", "ulp", "rel"))


def print_table(sheet: Json, runs: int) -> None:
    rows = sheet["rows"]
    kinds = [*(f"noise of {label}" for label in sheet["labels"]), TITLES[sheet["kind"]]]
    passes, names = (max([len(head), *(len(row[key]) for row in rows)]) for head, key in (("pass", "pass"), ("resource", "name")))
    width = max(map(len, kinds))
    print(f"\n{runs} runs of each side; of two runs that differ most:")
    print(f"{'pass':<{passes}}  {'resource':<{names}}  {'':{width}}  {'differing':>10}"
          + "".join(f"  {head:>8}" for head in ("median", "95 %", "99.9 %", "largest", "ulp", "relative")))
    for row in rows:
        place = f"{printable(row['pass']):<{passes}}  {printable(row['name']):<{names}}"
        found = [row["first"], row["second"], row["between"]]
        if not any(errors["not_comparable"] or errors["differing"] for errors in found):
            print(f"{place}  equal in all runs")
            continue
        for kind, errors in zip(kinds, found):
            print(f"{place}  {kind:<{width}}{error_cells(errors)}")
            place = " " * len(place)
    for row in rows:
        if row["breaks"]:
            what = "missing" if row["between"].get("missing") else "breaks its contract"
            print(printable(f"{row['pass']}, {row['name']}: {what} in some runs"))


# ---- Contracts -----------------------------------------------------------------------------------


def join(parts: list[Json]) -> Json:
    """The largest of each."""
    joined = {key: max(part.get(key, 0) for part in parts) for key in parts[0] if key != "beyond"}
    return {**joined, "beyond": [max(column) for column in zip(*(part["beyond"] for part in parts))]}


class Bound:
    """All errors of a key, over its passes, mips, frames and pairs of sides."""

    def __init__(self, key: str, row: Json):
        self.key, self.row = key, row
        self.parts: dict[str, list[Json]] = {kind: [] for kind in TITLES}
        self.exacts: list[Json] = []

    def add(self, row: Json, kind: str) -> None:
        self.parts["noise"] += [row["first"], row["second"]]
        self.parts[kind].append(row["between"])
        self.exacts.append(row["exact"])

    def outliers(self) -> int | None:
        """The first step below which all but one in a thousand elements are; None: the largest error is not far above."""
        everything = self.all
        step = next((i for i, beyond in enumerate(everything["beyond"]) if beyond * 1000 <= everything["elements"]), None)
        far = step is not None and everything["beyond"][step] and STEPS[step] * 8 < everything["largest"]
        return step if far else None

    def of_exact(self) -> str:
        """Of a fast pass: the largest distance of a side from the exact twin, or half the distance between two sides if that is
        more. The spec's own contract stays if it allows outliers and there are some."""
        given, error = self.row, max(self.exact["of_exact"], self.all["of_exact"] / 2)
        if given["contract"] == "of_exact" and given.get("outliers", 0) > 0 and error > given["tolerance"]:
            return f"{{of_exact: {given['tolerance']:.9g}, outliers: {given['outliers']:.9g}"
        return f"{{of_exact: {rounded_up(error)}"

    def choose(self) -> tuple[str, str]:
        """As tight as the errors are: the contract without its last brace, and the name of its measure."""
        found, step = self.all, self.outliers() if self.row["image"] else None
        if self.exact["differing"]:
            return self.of_exact(), "of_exact"
        if not found["differing"]:
            return "exact", ""
        if self.row["integers"]:
            return f"{{flips: {found['differing']:.0f}", "differing"
        if found["ulp"] <= FEW_ULP or (self.row["codes"] and step is None):
            return f"{{ulp: {math.ceil(found['ulp'])}", "ulp"
        if found["rel"] <= SMALL_REL:
            return f"{{rel: {rounded_up(found['rel'])}", "rel"
        if step is not None:
            share = rounded_up(found["beyond"][step] / found["elements"])
            return f"{{image: {{max: {STEPS[step]:.2g}, outliers: {share}}}", "largest"
        return f"{{abs: {rounded_up(found['largest'])}", "largest"

    def reason(self) -> str:
        """Why the contract is as it is."""
        words = [] if self.all["differing"] else ["equal in all runs"]
        if self.exact["differing"]:
            words.append(f"{self.exact['differing']:.0f} of {self.exact['elements']:.0f} differ from exact")
        for kind, errors in self.kinds.items():
            if self.all["differing"]:
                told = (f"{errors['differing']:.0f} of {errors['elements']:.0f} differ, 95 % below {errors['p95']:.3g}, "
                        f"largest {errors['largest']:.3g}")
                words.append(f"{TITLES[kind]}: {told if errors['differing'] else 'none'}")
        return "; ".join(words)

    def line(self) -> str:
        """Names are anybody's: YAML's quotes, where a plain word could mean something else."""
        self.kinds = {kind: join(parts) for kind, parts in self.parts.items() if parts}
        self.all, self.exact = join(list(self.kinds.values())), join(self.exacts)
        plain = re.fullmatch(r"[A-Za-z_.][A-Za-z0-9_.]*", self.key)
        name = self.key if plain else "'" + self.key.replace("'", "''") + "'"
        contract, measure = self.choose()
        if measure:
            amounts = {kind: math.inf if errors["not_comparable"] else errors[measure] for kind, errors in self.kinds.items()}
            contract += "".join(f", {kind}: {amount:.6g}" for kind, amount in amounts.items()) + "}"
        return f"{name}: {contract}  # {self.reason()}\n"


def rounded_up(value: float) -> str:
    """Up to three digits, more where these would be less than the value."""
    for digits in range(3, 17):
        scale = 10.0 ** ((math.floor(math.log10(value)) if value else 0) - digits + 1)
        text = f"{math.ceil(value / scale) * scale:.{digits}g}"
        if float(text) >= value:
            break
    return text


def contracts(console: Console, request: Json) -> str:
    bounds: dict[str, Bound] = {}
    for sheet in request["sheets"]:
        for row in sheet["rows"]:
            bounds.setdefault(row["key"], Bound(row["key"], row)).add(row, sheet["kind"])
    for bound in bounds.values():
        if any(part["not_comparable"] for parts in bound.parts.values() for part in parts):
            console.warning(f"{bound.key}: missing, NaN, Inf or other sizes in some runs: no contract allows them")
    runs = f"{request['runs']:.0f}"
    head = (f"# compare --measure {runs} --write-contracts: all of these runs keep them, and they are as tight as that.\n"
            f"measured: {runs}\n")
    return head + "".join(bound.line() for bound in bounds.values())


def main(console: Console, request: Json) -> tuple[int, Json]:
    if "write_contracts" in request:
        write(request["write_contracts"], contracts(console, request))
        return 0, {}
    for sheet in request["sheets"]:
        print_table(sheet, request["runs"])
    return 0, {}
