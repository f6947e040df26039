"""Random GLSL programs, each as it is and in another form of the same meaning, on every side. Prints TAP.

    random_glsl.py [--seed N] [--programs N] BUILD SIDE...

A program is a list of statements, evaluated here with float32 and 32-bit integers. Its forms: plain; through functions; with names
that the generator or GLSL has. All forms leave the bits that the evaluation gives."""
import argparse
import os
import random
import re
import shutil
import sys

import numpy as np

import bodies

F32 = np.float32
SLOTS = 2          # results of a program
PER_BODY = 2       # programs of a body: drivers take long over long shaders
FORMS = ("plain", "functions", "names")
PARAMS = {"one": F32(1), "two": F32(2), "three": F32(3), "half_": F32(0.5)}
NAMES = ["PI", "View", "Light", "saturate", "round_", "luminance", "hash", "view", "frame", "camera", "light", "invocation", "exact_mix",
         "approximate_sqrt", "metric_dot", "store_half", "filter_blend", "scene_radius", "hammersley", "tile_class"]


class Bad(Exception):
    """A value that this test leaves out: too large, too small, undefined."""


# ---- Values -------------------------------------------------------------------------------------

def checked(value):
    if isinstance(value, np.ndarray):
        for x in value:
            checked(x)
        return value
    if isinstance(value, F32) and (not np.isfinite(value) or abs(value) > 1e15 or 0 < abs(value) < 1e-15):
        raise Bad
    return value


def wrap(value, kind):
    value &= 0xffffffff
    return value - (1 << 32) if kind == "int" and value >= 1 << 31 else value


def fract(x):
    part = x - np.floor(x)
    return np.where(part >= 1, F32(1) - F32(2) ** F32(-24), part).astype(F32)[()] if isinstance(x, np.ndarray) else \
        (F32(1) - F32(2) ** F32(-24) if part >= 1 else part)


def low(x, y):
    return np.where(y < x, y, x)[()]


def high(x, y):
    return np.where(x < y, y, x)[()]


def dot(a, b):
    total = a[0] * b[0]
    for i in range(1, len(a)):
        total = F32(total + a[i] * b[i])
    return F32(total)


def smoothstep(a, b, x):
    t = low(high((x - a) / (b - a), F32(0)), F32(1))
    return F32(t * t * (F32(3) - F32(2) * t))


def root(x):
    if np.any(x < 0):
        raise Bad
    return np.sqrt(x)


CALLS = {  # name: (arguments, function); g: float or a vector of one size
    "abs": ("g", np.abs), "floor": ("g", np.floor), "ceil": ("g", np.ceil), "trunc": ("g", np.trunc), "fract": ("g", fract),
    "sqrt": ("g", root), "min": ("gg", low), "max": ("gg", high), "mix": ("ggg", lambda x, y, a: x * (F32(1) - a) + y * a),
    "step": ("gg", lambda edge, x: np.where(x < edge, F32(0), F32(1))[()]), "sign": ("g", np.sign),
}
OPERATORS = {"+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b, "/": lambda a, b: a / b}


def divide(a, b):
    if np.any(b == 0):
        raise Bad
    return a / b


OPERATORS["/"] = divide

# ---- Expressions: tuples; the first word says of what kind, the second of what type --------------


class Maker:
    """Makes the statements of one program."""

    def __init__(self, source):
        self.source = source
        self.variables = {"float": [], "vec2": [], "vec3": [], "int": [], "uint": []}
        self.count = 0

    def pick(self, *choices):
        return self.source.choice(choices)

    def name(self):
        self.count += 1
        return f"v{self.count}"

    def leaf(self, kind):
        known = self.variables[kind]
        if known and self.source.random() < 0.7:
            return ("var", kind, self.source.choice(known))
        if kind == "float":
            return ("param", kind, self.pick(*PARAMS))
        if kind == "int":
            return ("to_int", kind, ("param", "float", self.pick("one", "two", "three")))
        if kind == "uint":
            return ("to_uint", kind, ("param", "float", self.pick("one", "two", "three")))
        return ("vector", kind, [self.leaf("float") for _ in range(int(kind[3]))])

    def literal(self, kind):
        if kind == "float":
            return ("literal", kind, self.pick(0.25, 0.5, 1.5, 2.0, 3.0, 0.1, 0.7, 5.0, 7.25, 0.333))
        return ("literal", kind, self.pick(1, 2, 3, 5, 7, 12, 31, 255))

    def right(self, kind, depth):
        """An operand that may be a literal, since the other one is none."""
        scalar = kind in ("float", "int", "uint")
        return self.literal(kind) if scalar and self.source.random() < 0.3 else self.expression(kind, depth)

    def expression(self, kind, depth):
        if depth <= 0:
            return self.leaf(kind)
        if kind in ("int", "uint"):
            return self.integer(kind, depth)
        roll = self.source.random()
        if roll < 0.5:
            symbol = self.pick("+", "+", "-", "-", "*", "*", "/")
            return ("operator", kind, symbol, self.expression(kind, depth - 1), self.right(kind, depth - 1))
        if roll < 0.58 and kind != "float":
            return ("operator", kind, self.pick("*", "/"), self.expression(kind, depth - 1), self.expression("float", depth - 1))
        if roll < 0.66:
            return ("choose", kind, self.condition(depth - 1), self.expression(kind, depth - 1), self.expression(kind, depth - 1))
        if roll < 0.7:
            return ("minus", kind, self.expression(kind, depth - 1))
        if kind == "float":
            if roll < 0.76:
                size = self.pick("vec2", "vec3")
                return ("dot", kind, self.expression(size, depth - 1), self.expression(size, depth - 1))
            if roll < 0.8:
                return ("length", kind, self.expression(self.pick("vec2", "vec3"), depth - 1))
            if roll < 0.84:
                return ("part", kind, self.expression("vec3", depth - 1), self.pick("x", "y", "z"))
            if roll < 0.88:
                return ("smoothstep", kind, self.expression(kind, depth - 1))
            if roll < 0.92:
                return ("from_int", kind, self.expression(self.pick("int", "uint"), depth - 1))
        elif roll < 0.8:
            return ("vector", kind, [self.expression("float", depth - 2) for _ in range(int(kind[3]))])
        name = self.pick(*CALLS)
        return ("call", kind, name, [self.expression(kind, depth - 1) for _ in CALLS[name][0]])

    def integer(self, kind, depth):
        symbol = self.pick("+", "-", "*", "&", "|", "^", "<<", ">>", "/", "%")
        left = self.expression(kind, depth - 1)
        if symbol in ("<<", ">>"):
            return ("shift", kind, symbol, left, self.right(kind, depth - 1))
        if symbol in ("/", "%"):
            left = ("operator", kind, "&", left, ("literal", kind, 65535))
            return ("operator", kind, symbol, left, ("literal", kind, self.pick(3, 7, 10)))
        return ("operator", kind, symbol, left, self.right(kind, depth - 1))

    def condition(self, depth):
        kind = self.pick("float", "int")
        return ("compare", "bool", self.pick("<", ">", "<=", ">="), self.expression(kind, depth), self.right(kind, depth))

    # Statements.
    def declare(self, kind=None):
        kind = kind or self.pick("float", "float", "vec2", "vec3", "int", "uint")
        made = ("declare", kind, self.name(), self.expression(kind, 2))
        self.variables[kind].append(made[2])
        return made

    def assign(self):
        kind = self.pick("float", "vec2", "vec3")
        if not self.variables[kind]:
            return self.declare(kind)
        name = self.source.choice(self.variables[kind])
        return ("assign", kind, name, self.pick("=", "+=", "-=", "*=", "/="), self.expression(kind, 2))

    def block(self, count):
        kept = {kind: list(names) for kind, names in self.variables.items()}
        made = [self.assign() for _ in range(count)]
        self.variables = kept
        return made

    def statement(self):
        roll = self.source.random()
        if roll < 0.45:
            return self.declare()
        if roll < 0.7:
            return self.assign()
        if roll < 0.8:
            return ("if", None, self.condition(2), self.block(2), self.block(1))
        if roll < 0.9:
            return ("for", None, self.name(), self.source.randint(1, 4), self.block(2))
        return ("array", None, self.name(), self.name(), [self.expression("float", 1) for _ in range(3)], self.pick("+=", "*=", "/="),
                self.expression("float", 1))

    def program(self):
        statements = [self.declare("float"), self.declare("vec3")] + [self.statement() for _ in range(self.source.randint(1, 4))]
        return statements, [self.expression("float", 2) for _ in range(SLOTS)]


# ---- Evaluation ---------------------------------------------------------------------------------

def value_of(node, known):
    what, kind = node[0], node[1]
    sub = [value_of(part, known) for part in node[2:] if isinstance(part, tuple)]
    if what == "var":
        return known[node[2]]
    if what == "param":
        return PARAMS[node[2]]
    if what == "literal":
        return F32(node[2]) if kind == "float" else node[2]
    if what in ("to_int", "to_uint"):
        return int(sub[0])
    if what == "from_int":
        return F32(sub[0])
    if what == "vector":
        return checked(np.array([value_of(part, known) for part in node[2]], F32))
    if what == "operator" and kind in ("int", "uint"):
        return integer_value(node[2], kind, *sub)
    if what == "operator":
        return checked(OPERATORS[node[2]](*sub))
    if what == "shift":
        count, left = sub[1] & 31, sub[0]
        return wrap(left << count, kind) if node[2] == "<<" else wrap(left >> count, kind)
    if what == "choose":
        return sub[1] if sub[0] else sub[2]
    if what == "minus":
        return -sub[0]
    if what == "compare":
        return bool({"<": sub[0] < sub[1], ">": sub[0] > sub[1], "<=": sub[0] <= sub[1], ">=": sub[0] >= sub[1]}[node[2]])
    if what == "dot":
        return checked(dot(*sub))
    if what == "length":
        return checked(np.sqrt(checked(dot(sub[0], sub[0]))))
    if what == "part":
        return sub[0]["xyz".index(node[3])]
    if what == "smoothstep":
        return smoothstep(F32(0), F32(3), sub[0])
    assert what == "call", what
    result = CALLS[node[2]][1](*(value_of(part, known) for part in node[3]))
    return checked(result.astype(F32) if isinstance(result, np.ndarray) else F32(result))


def integer_value(symbol, kind, a, b):
    result = {"+": a + b, "-": a - b, "*": a * b, "&": a & b, "|": a | b, "^": a ^ b}.get(symbol)
    if result is None:
        result = a // b if symbol == "/" else a % b
    return wrap(result, kind)


def run_statements(statements, known):
    for node in statements:
        what = node[0]
        if what == "declare":
            known[node[2]] = value_of(node[3], known)
        elif what == "assign":
            right = value_of(node[4], known)
            known[node[2]] = right if node[3] == "=" else checked(OPERATORS[node[3][0]](known[node[2]], right))
        elif what == "if":
            run_statements(node[3] if value_of(node[2], known) else node[4], known)
        elif what == "for":
            for _ in range(node[3]):
                run_statements(node[4], known)
        else:
            values = [value_of(part, known) for part in node[4]]
            right = value_of(node[6], known)
            values[0] = checked(OPERATORS[node[5][0]](values[0], right))
            known[node[2]] = checked(checked(values[0] + values[1]) * values[2])


# ---- Text ---------------------------------------------------------------------------------------

class Writer:
    """Writes a program in one form."""

    def __init__(self, form, number, source):
        self.form, self.number, self.source = form, number, source
        self.head, self.made, self.names = [], {}, {}

    def name(self, name):
        if self.form != "names":
            return name
        if name not in self.names:
            free = [word for word in NAMES if word not in self.names.values()]
            self.names[name] = self.source.choice(free) if free and self.source.random() < 0.5 else f"renamed_{name}"
        return self.names[name]

    def through(self, key, kind, kinds, text):
        """A function of arguments a, b, ... that stands for the text."""
        if key not in self.made:
            name = self.made[key] = f"m{self.number}_{len(self.made)}"
            parameters = ", ".join(f"{one} {word}" for one, word in zip(kinds, "abc"))
            shown = re.sub("<([abc])>", r"\1", text)
            self.head.append(f"{kind} {name}({parameters}) {{ return {shown}; }}")
        return self.made[key]

    def wrapped(self, key, kind, kinds, text, parts):
        """The text with its parts in place of <a>, <b>: as it is, or through a function."""
        if self.form == "functions" and self.source.random() < 0.5:
            return f"{self.through((key, kind, tuple(kinds)), kind, kinds, text)}({', '.join(parts)})"
        for word, part in zip("abc", parts):
            text = text.replace(f"<{word}>", part)
        return f"({text})"

    def expression(self, node):
        what, kind = node[0], node[1]
        parts = [self.expression(part) for part in node[2:] if isinstance(part, tuple)]
        kinds = [part[1] for part in node[2:] if isinstance(part, tuple)]
        if what == "var":
            return self.name(node[2])
        if what == "param":
            return node[2]
        if what == "literal":
            return repr(float(node[2])) if kind == "float" else f"{node[2]}{'u' if kind == 'uint' else ''}"
        if what in ("to_int", "to_uint", "from_int"):
            return f"{kind}({parts[0]})"
        if what == "vector":
            return f"{kind}({', '.join(self.expression(part) for part in node[2])})"
        if what in ("operator", "shift"):
            return self.wrapped((what, node[2]), kind, kinds, f"<a> {node[2]} <b>", parts)
        if what == "choose":
            return f"({parts[0]} ? {parts[1]} : {parts[2]})"
        if what == "minus":
            return f"(-{parts[0]})"
        if what == "compare":
            return f"({parts[0]} {node[2]} {parts[1]})"
        if what in ("dot", "length"):
            return f"{what}({', '.join(parts)})"
        if what == "part":
            return f"{parts[0]}.{node[3]}"
        if what == "smoothstep":
            return f"smoothstep(0.0, 3.0, {parts[0]})"
        parts = [self.expression(part) for part in node[3]]
        inner = ", ".join(f"<{'abc'[i]}>" for i in range(len(parts)))
        return self.wrapped(node[2], kind, [kind] * len(parts), f"{node[2]}({inner})", parts)

    def statements(self, nodes):
        lines = []
        for node in nodes:
            what = node[0]
            if what == "declare":
                lines.append(f"{node[1]} {self.name(node[2])} = {self.expression(node[3])};")
            elif what == "assign":
                lines.append(f"{self.name(node[2])} {node[3]} {self.expression(node[4])};")
            elif what == "if":
                lines += [f"if ({self.expression(node[2])}) {{", *self.statements(node[3]), "} else {", *self.statements(node[4]), "}"]
            elif what == "for":
                i = self.name(node[2])
                lines += [f"for (int {i} = 0; {i} < {node[3]}; {i}++) {{", *self.statements(node[4]), "}"]
            else:
                array, index = self.name(node[2]) + "_array", self.name(node[3])
                lines += [f"float {array}[3] = float[3]({', '.join(self.expression(part) for part in node[4])});", f"int {index} = 0;",
                          f"{array}[{index}++] {node[5]} {self.expression(node[6])};",
                          f"float {self.name(node[2])} = ({array}[{index} - 1] + {array}[{index}]) * {array}[{index} + 1];"]
        return lines

    def program(self, statements, results):
        body = self.statements(statements)
        body += [f"result[{SLOTS * self.number + i}] = {self.expression(node)};" for i, node in enumerate(results)]
        return "\n".join([*self.head, f"void program_{self.number}()", "{", *body, "}", ""])


# ---- Tests --------------------------------------------------------------------------------------

def make(source):
    """A program whose values stay in range: statements, results, and the bits that they have."""
    with np.errstate(all="ignore"):
        while True:
            statements, results = Maker(source).program()
            known = {}
            try:
                run_statements(statements, known)
                values = [value_of(node, known) for node in results]
            except Bad:
                continue
            return statements, results, [bodies.as_bits(float(value)) & (0xffffffff if value else 0) for value in values]


def body_of(programs, form, source):
    text = [Writer(form, number, source).program(*program[:2]) for number, program in enumerate(programs)]
    calls = "".join(f"    program_{number}();\n" for number in range(len(programs)))
    return "\n".join(text) + f"void main()\n{{\n{calls}}}\n"


def plain(bits):
    """Zeros of either sign alike: a driver may fold x + 0.0."""
    return 0 if bits == 0x80000000 else bits


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--programs", type=int, default=150)
    parser.add_argument("build")
    parser.add_argument("sides", nargs="+")
    arguments = parser.parse_args()
    tap = bodies.Tap()
    source = random.Random(arguments.seed)
    print(f"# seed {arguments.seed}, {arguments.programs} programs", flush=True)
    folder = os.path.join(os.path.abspath(arguments.build), "tests/random_glsl")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    programs, wanted, counts = {}, {}, {}
    for first in range(0, arguments.programs, PER_BODY):
        batch = [make(source) for _ in range(min(PER_BODY, arguments.programs - first))]
        for form in ("plain", FORMS[1 + first // PER_BODY % (len(FORMS) - 1)]):
            name = f"p{first}_{form}"
            programs[name], counts[name] = batch, SLOTS * len(batch)
            wanted[name] = [bits for program in batch for bits in program[2]]
            with open(os.path.join(folder, f"{name}.glsl"), "w", encoding="utf-8") as file:
                file.write(body_of(batch, form, source))
    rendered = bodies.Bodies(arguments.build, folder, counts)
    for side in arguments.sides:
        test_side(tap, rendered, folder, wanted, side)
    test_fast(tap, rendered, wanted, next(side for side in arguments.sides if side.startswith("vk")))
    tap.finish()


def test_side(tap, rendered, folder, wanted, side):
    names = list(wanted)
    try:
        results, reasons = rendered.render(names, side, "exact"), []
    except bodies.Failure:
        failed = bodies.guilty(names, lambda some: rendered.render(some, side, "exact"))
        names = [name for name in names if name not in failed]
        results = rendered.render(names, side, "exact")
        reasons = [f"{folder}/{name}.glsl does not run\n{text}" for name, text in failed.items()]
    for name, seen in results.items():
        for i, (got, want) in enumerate(zip(seen, wanted[name])):
            if plain(got) != plain(want):
                reasons.append(f"{folder}/{name}.glsl: result[{i}], of program_{i // SLOTS}: {bodies.as_float(got):.9g} ({got:#010x}), "
                               f"by IEEE 754 {bodies.as_float(want):.9g} ({want:#010x})")
    tap.result(f"{len(wanted)} bodies of random programs, each in two forms, have the bits of IEEE 754 on {side}", reasons[:20])


def test_fast(tap, rendered, wanted, side):
    """Rounding may decide a condition or a floor: few programs may differ."""
    names = [name for name in wanted if name.endswith("_plain")]
    results = rendered.render(names, side, "fast")
    differ = sum(not bodies.near(bodies.as_float(got), bodies.as_float(want))
                 for name in names for got, want in zip(results[name], wanted[name]))
    most = sum(len(wanted[name]) for name in names) // 20
    tap.result(f"fast results are near on {side}, but for {differ} of {20 * most} that rounding decides",
               [f"{differ} differ, at most {most} may"] if differ > most else [])


if __name__ == "__main__":
    sys.setrecursionlimit(10000)
    main()
