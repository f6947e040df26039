"""How state and uniforms of two matched passes differ, in words, for compare.py. Conventions of the two APIs are no differences:
the order of rows, and matrices that differ by clip space alone."""
from __future__ import annotations

import os
import re
from typing import Any, Iterator

import numpy as np

Json = dict[str, Any]
MOST_TOLD = 6  # uniforms of a pass
BOTH = ((False, False), (False, True), (True, False), (True, True))  # a window and a texture may have rows in other orders
SHAPES = {8: (2, 4), 9: (3, 3), 16: (4, 4)}  # of matrices into clip space, by how many numbers they have
ZINK = re.compile(r"\w+ (uniform_0|ubos_1)\[")
CLOCK = re.compile(r"time|clock|cycle|elapsed|ticks?$|frame_?(count|number|index|id)", re.I)


def text_of(value: Any) -> str:
    if isinstance(value, list):
        return f"({', '.join(map(text_of, value))})" if len(value) != 1 else text_of(value[0])
    return f"{value:.6g}" if isinstance(value, (int, float)) else str(value)


# ---- State ---------------------------------------------------------------------------------------


def normal(state: Json, turned: bool, mirrored: bool) -> Json:
    """As the other side would say it: `turned`: rows are in the opposite order; `mirrored`: triangles wind the other way."""
    found = dict(state)
    if not state:
        return found
    for key in ("viewport", "scissor"):
        if state[key]:
            x, y, width, height = state[key]
            y, height = (y + height, -height) if height < 0 else (y, height)
            found[key] = [x, state["height"] - y - height if turned else y, width, height]
    view, cut = found["viewport"], found["scissor"]
    if cut and cut[0] <= view[0] and cut[1] <= view[1] and cut[0] + cut[2] >= view[0] + view[2] and cut[1] + cut[3] >= view[1] + view[3]:
        found["scissor"] = []
    if mirrored:
        found["front"] = {"ccw": "cw", "cw": "ccw"}[state["front"]]
    if state["cull"] == "nocull":
        del found["front"]
    return found


def other_front(state: Json) -> Json:
    """The same state, of a program that calls the other side of triangles the front."""
    found = dict(state)
    if {"front", "cull", "stencil front", "stencil back"} <= state.keys():
        cull = {"front": "back", "back": "front"}.get(state["cull"], state["cull"])
        found.update(front={"ccw": "cw", "cw": "ccw"}[state["front"]], cull=cull)
        found.update({"stencil front": state["stencil back"], "stencil back": state["stencil front"]})
    return found


def offset_text(first: list[float], second: list[float]) -> str:
    def side(offset: list[float]) -> str:
        return f"factor {text_of(offset[1])}, units {text_of(offset[0])}" + (f", clamp {text_of(offset[2])}" if offset[2] else "")

    swapped = first[:2] == second[1::-1] or np.allclose(first[:2], second[1::-1])
    return f"polygon offset: {side(first)} against {side(second)}" + (": factor and units are swapped" if swapped else "")


def same_value(one: Any, other: Any) -> bool:
    numbers = isinstance(one, list) and one and all(isinstance(item, (int, float)) for item in one)
    return bool(one == other or (numbers and len(one) == len(other) and np.allclose(one, other, rtol=1e-5)))


def state_texts(first: Json, second: Json) -> list[str]:
    texts = []
    without_depth = "off" == first.get("depth test") == second.get("depth test")
    for key in first.keys() & second.keys():
        one, other = first[key], second[key]
        if key == "height" or same_value(one, other) or (key == "depth range" and without_depth):
            continue
        if key == "polygon offset":
            texts.append(offset_text(one, other))
        else:
            texts.append(f"{key}: {text_of(one) if one != [] else 'whole'} against {text_of(other) if other != [] else 'whole'}")
    return sorted(texts)


# ---- Uniforms ------------------------------------------------------------------------------------


def bare(name: str) -> str:
    """Without its block, and without what compilers put around names."""
    return re.sub(r"^_+|(_\d+)+$|(?<=\w)Texture$", "", name.rsplit(".", 1)[-1])


def made_up(uniforms: dict[str, Any]) -> bool:
    """Whether a compiler named them all."""
    return bool(uniforms) and all(re.match(r"_child\d+|res\d+|_\d+", name.rsplit(".", 1)[-1]) for name in uniforms)


def common(first: dict[str, Any], second: dict[str, Any]) -> list[tuple[str, Any, Any]]:
    """Values of one name; where the second side's shaders have no names, those of one place."""
    if made_up(second) and len(first) == len(second):
        return [(name, one, other) for (name, one), other in zip(first.items(), second.values())]
    pairs = [(name, first[name], second[name]) for name in first if name in second]
    names = [{}, {}]  # type: list[dict[str, list[str]]]
    for side, found in zip((first, second), names):
        for name in side:
            if name not in first or name not in second:
                found.setdefault(bare(name), []).append(name)
    for name, own in names[0].items():
        both = [[side[item] for item in items] for side, items in ((first, own), (second, names[1].get(name, [])))]
        if all(items and all(item == items[0] for item in items) for items in both):  # blocks of two stages may have one
            pairs.append((name, both[0][0], both[1][0]))
    return pairs


def clip_space(first: np.ndarray, second: np.ndarray) -> bool:
    """Whether the second matrix is the first, with y turned, depth of 0 to 1, or both; or their inverses are."""
    half = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, .5, .5], [0, 0, 0, 1]])
    for own, other in ((first, second), (first.T, second.T)):
        rows = len(own)
        for turn in (1, -1):
            for depth in (np.eye(4), half, np.linalg.inv(half)) if rows == 4 else (np.eye(rows),):
                clip = np.diag([1, turn, 1, 1][:rows]) @ depth
                ways = [clip @ own] + ([own @ np.linalg.inv(clip)] if rows == own.shape[1] else [])
                if any(np.allclose(way, other, rtol=1e-4, atol=1e-5) for way in ways):
                    return True
    return False


def plain(values: list[Any]) -> tuple[list[float], int]:
    """The numbers of a uniform; of a matrix whose rows lie one after the other, how many columns it has."""
    return (values[0], values[1]) if values and isinstance(values[0], list) else (values, 0)


def same_uniform(one: np.ndarray, other: np.ndarray) -> bool:
    return np.allclose(one, other, rtol=1e-6, atol=0, equal_nan=True) or (
        len(one) in SHAPES and one.shape == other.shape and clip_space(one.reshape(SHAPES[len(one)]), other.reshape(SHAPES[len(one)])))


def bits_at(words: Json, start: str) -> np.ndarray:
    """Of the words whose names start so, in order."""
    there = [value[0] for name, value in words["uniforms"].items() if name.startswith(start)]
    return np.array([np.float32(value).view("u4") if isinstance(value, float) else value for value in there], "u4")


def loose_words(named: Json, bits: np.ndarray, names: list[str]) -> tuple[dict[str, Any], list[str]]:
    """Of a stage's uniforms without a block."""
    own, at = {}, 0  # type: dict[str, tuple[np.ndarray, np.ndarray, list[Any]]], int
    for name in names:
        values = named["uniforms"][name]
        whole = not isinstance(values[0], float)
        wanted = np.array([value & 0xffffffff for value in values], "u4") if whole else np.array(values, "f4").view("u4")
        theirs = bits[at:at + len(values)]
        if whole and set(values) <= {0, 1} and set(theirs.tolist()) <= {0, 0x3f800000, 0xffffffff}:  # how Mesa has booleans
            theirs = (theirs != 0).astype("u4")
        same = np.array_equal(wanted, theirs)
        own[name] = (wanted, theirs, values if same else theirs.view("i4" if whole else "f4").tolist())
        at += len(values)
    both = [np.sort(np.concatenate([pair[side] for pair in own.values()] or [bits])) for side in (0, 1)]
    if at > len(bits):
        return {}, []
    if np.array_equal(both[0], both[1]):  # equal, or in another order
        return {name: named["uniforms"][name] for name in own}, []
    if 2 * sum(np.array_equal(*pair[:2]) for pair in own.values()) >= len(own) - (len(own) == 1):
        return {name: theirs for name, (*_, theirs) in own.items()}, []
    return {}, [name for name, (wanted, *_) in own.items()
                if not any(np.array_equal(wanted, bits[start:start + len(wanted)]) for start in range(len(bits)))]


def worded(named: Json, words: Json) -> tuple[dict[str, Any], list[str]]:
    """Of uniforms that the first side names, the values that Zink keeps as words; and names of those whose values are nowhere there,
    where its order is not that of locations: a stage before has uniforms of this one, too. Blocks are in the same order."""
    found, lost = {}, []  # type: dict[str, Any], list[str]
    for stage, names in named["loose"].items():
        own, gone = loose_words(named, bits_at(words, f"{stage} uniform_0["), names)
        found.update(own)
        lost += gone
    for stage, laid in named["laid"].items():
        for number, block in enumerate(laid, 1):
            bits = bits_at(words, f"{stage} ubos_{number}[")
            for name, places in block.items():
                values, wide = plain(named["uniforms"][name])
                if max(places) < 4 * len(bits):
                    kind = "f4" if isinstance(values[0], float) else "i4" if min(values) < 0 else "u4"
                    theirs = bits[np.array(places) // 4].view(kind).tolist()
                    found[name] = [theirs, wide] if wide else theirs
    return found, lost


def uniform_differences(first: dict[str, Any], second: dict[str, Any]) -> list[tuple[str, str]]:
    """Names and values."""
    found = []
    for name, *both in common(first, second):
        (one, wide), (other, wide_too) = map(plain, both)
        turns = [other]
        if bool(wide) != bool(wide_too) and len(one) == len(other):  # HLSL's are transposed in SPIR-V
            turns.append(np.reshape(other, (wide, -1) if wide else (-1, wide_too)).T.ravel().tolist())
        one, turns = one[:len(other)], [turn[:len(one)] for turn in turns]
        if not any(same_uniform(np.array(one, "f8"), np.array(turn, "f8")) for turn in turns):
            found.append((name, f"{text_of(one)} against {text_of(other)}"))
    return found


# ---- Vertices ------------------------------------------------------------------------------------


def stream_differences(first: Json, second: Json, folders: list[str], across: bool) -> dict[str, str]:
    """Of the vertices and indices of a draw, by name: {name: [file, numbers of a row]}. What is turned for the other API is equal."""
    found = {}
    for name, *both in common(first, second):
        a, b = (np.fromfile(os.path.join(folder, file), "<f4").reshape(-1, width) for folder, (file, width) in zip(folders, both))
        turns = [a, *(np.concatenate([a[:, :1], y, a[:, 2:]], 1) for y in (-a[:, 1:2], 1 - a[:, 1:2]) if across)]
        if a.shape != b.shape:
            found[f"vertex data {name}"] = f"{len(a)} of {a.shape[1]} numbers against {len(b)} of {b.shape[1]}"
        elif name == "indices" and ((a < 0) != (b < 0)).any():
            found[f"vertex data {name}"] = "primitives restart at other places"
        elif not any(np.allclose(turn, b, rtol=1e-6, atol=1e-6, equal_nan=True) for turn in turns):
            gaps = np.abs(a - b)[a != b]
            found[f"vertex data {name}"] = f"{len(gaps)} of {a.size} numbers differ, by up to {text_of(float(gaps.max()))}"
    return found


# ---- A pass --------------------------------------------------------------------------------------


def blit(region: list[list[float]], *turns: bool) -> str:
    """From where to where, with rows of either in the opposite order, and how, where sizes differ."""
    parts = [list(corners) for corners in region[:2]]
    for part, height, turned in zip(parts, region[3], turns):
        if turned:
            part[1], part[3] = height - part[1], height - part[3]
    for low, high in ((0, 2), (1, 3)):
        if parts[1][low] > parts[1][high]:
            for part in parts:
                part[low], part[high] = part[high], part[low]
    sizes = [[abs(part[2] - part[0]), abs(part[3] - part[1])] for part in parts]
    how = "" if sizes[0] == sizes[1] else ", linear" if region[2][0] else ", nearest"
    return f"{text_of(parts[0])} to {text_of(parts[1])}{how}"


def shared(items: list[Json]) -> Json:
    """What all have alike."""
    return {key: value for key, value in items[0].items() if all(key in item and same_value(item[key], value) for item in items)}


def same_keys(first: list[Any], second: list[Any], least: int = 0) -> list[tuple[int, int]]:
    """Draws of equal keys, in order, where both sides have as many of a key, and it has more than so many vertices."""
    places = [{}, {}]  # type: list[dict[Any, list[int]]]
    for keys, found in zip((first, second), places):
        for at, key in enumerate(keys):
            found.setdefault(key, []).append(at)
    return sorted(pair for key, own in places[0].items() if len(own) == len(places[1].get(key, [])) and key[0] > least
                  for pair in zip(own, places[1][key]))


def aligned(first: list[list[int]], second: list[list[int]]) -> list[tuple[int, int]]:
    """Draws that belong together. Where sides have other draws, or another order, those with as many vertices: quads are too alike to tell.
    Where one side draws several parts at once, those that begin after as many, up to where the sides are out of step."""
    sizes = [[int(np.prod(count)) for count in counts] for counts in (first, second)]
    keys = [[(size, *count) for size, count in zip(*both)] for both in zip(sizes, (first, second))]
    if len(first) == len(second):
        same = 2 * sum(one == other for one, other in zip(first, second)) >= len(first)
        return [(at, at) for at in range(len(first))] if same or sorted(first) != sorted(second) else same_keys(keys[0], keys[1])
    starts = [{int(start): at for at, start in enumerate([0, *np.cumsum(size)])} for size in sizes]
    places = [(at, starts[1][start]) for start, at in starts[0].items() if start in starts[1]]
    found: list[tuple[int, int]] = []
    for (at, other), after in zip(places, places[1:]):
        if min(after[0] - at, after[1] - other) > 1:
            break
        found += [(at, other)] if sizes[0][at] > 6 else []
    alike = same_keys(keys[0], keys[1], 6)
    return alike if len(alike) > len(found) else found


def in_order(first: Json, second: Json) -> list[tuple[int, int]]:
    """Draws that belong together. Of those with as many vertices, vertices and uniforms tell: a side may draw them in another order."""
    pairs = aligned(first["counts"], second["counts"])
    groups: dict[str, list[list[int]]] = {}
    looked = [{item["draw"]: item for item in side["states"]} for side in (first, second)]
    for at, other in pairs:
        if at in looked[0] and other in looked[1] and first["counts"][at] == second["counts"][other]:
            for places, place in zip(groups.setdefault(str(first["counts"][at]), [[], []]), (at, other)):
                places.append(place)
    found = dict(pairs)
    for own, theirs in groups.values():
        for key in (lambda item: (item["streams"], item["uniforms"], item["samplers"]), lambda item: item["streams"],
                    lambda item: item["streams"].get("indices"), lambda _: 0):
            for at in list(own):
                alike = [other for other in theirs if key(looked[0][at]) == key(looked[1][other])]
                if alike:
                    found[at] = alike[0]
                    own.remove(at)
                    theirs.remove(alike[0])
    return sorted(found.items())


def alone(counts: list[list[list[int]]], pairs: list[tuple[int, int]]) -> str:
    """Which draws of either side have no partner, where most have one."""
    if 2 * len(pairs) < min(map(len, counts)) or sorted(counts[0]) == sorted(counts[1]):
        return ""
    texts = []
    for side, name in ((0, "the first"), (1, "the second")):
        paired = {pair[side] for pair in pairs}
        free = [f"{at + 1} ({text_of(count[:1])} vertices)" for at, count in enumerate(counts[side]) if at not in paired]
        texts += [f"in {name} alone: draw {', '.join(free[:3])}" + (f" and {len(free) - 3} more" if len(free) > 3 else "")] if free else []
    return "".join("; " + text for text in texts)


def steps(first: Json, second: Json, *how: bool) -> Iterator[tuple[int, Json, Json, bool]]:
    """Draws with their state on both sides, as `how` has the second's normal, and whether both were looked at, so that uniforms and
    samplers are theirs. Of draw -1: what all draws of each side share, where they are parted otherwise."""
    sides = [{item["draw"]: {**item, "state": normal(item["state"], *turns)} for item in side["states"]}
             for side, turns in ((first, (False, False)), (second, how))]
    if not all(sides):
        return
    pairs = in_order(first, second)
    if not pairs:
        merged: list[Json] = [{key: shared([item[key] for item in side.values()]) for key in ("state", "uniforms", "samplers")}
                              for side in sides]
        for item in merged:  # words have no order without their neighbours, and draws that are parted have other vertices
            item.update(loose={}, laid={}, streams={})
        yield -1, merged[0], merged[1], True
    for at, other in pairs:
        looked = first["chosen"][at], second["chosen"][other]
        if min(looked) < 0:  # too many states
            continue
        both = looked == (at, other) and (first["counts"][at] == second["counts"][other] or first["kind"] == "dispatch")
        yield at, sides[0][looked[0]], sides[1][looked[1]], both


def differences(first: Json, second: Json, folders: list[str], turned: bool, across: bool, ported: bool
                ) -> tuple[list[str], list[str], int]:
    """What differs, which of it is a clock, and of how many draws the state was compared. `across`: the captures are of different APIs;
    `ported`: or one of them of OpenGL that Zink drew."""
    texts: list[str] = []
    moved: list[str] = []
    if first["kind"] != second["kind"]:
        texts.append(f"{first['kind']} against {second['kind']}")
    elif first["kind"] == "mips":  # made by one call or by several
        pass
    elif first["draws"] != second["draws"]:
        counts = [first["counts"], second["counts"]]
        texts.append(f"{first['draws']} against {second['draws']} draws" + alone(counts, aligned(*counts)))
    elif sorted(first["counts"]) == sorted(second["counts"]) and first["counts"] != second["counts"]:
        texts.append("draws in another order")
    elif first["counts"] != second["counts"]:
        at = next(index for index, pair in enumerate(zip(first["counts"], second["counts"])) if pair[0] != pair[1])
        what = "groups" if first["kind"] == "dispatch" else f"draw {at + 1}: vertices and instances"
        texts.append(f"{what} {text_of(first['counts'][at])} against {text_of(second['counts'][at])}")
    cleared = [(key, *(side["clears"][key] for side in (first, second))) for key in first["clears"] if key in second["clears"]]
    texts += [f"clear of {key}: {text_of(one)} against {text_of(other)}" for key, one, other in cleared if not same_value(one, other)]
    if len(first["region"]) == 4 == len(second["region"]):
        way, ways = blit(first["region"]), [blit(second["region"], *turns) for turns in ((turned, turned), *BOTH * ported)]
        texts += [f"{first['kind']}: {way} against {ways[0]}"] if way not in ways else []
    draws: dict[str, list[int]] = {}  # that a text is true of
    clocks: set[str] = set()
    told: set[str] = set()
    looked, compared = 0, 0
    details: dict[str, str] = {}
    for at, one, other, both in steps(first, second, turned, across != turned):
        compared += at >= 0
        found = min((state_texts(one["state"], state) for state in (other["state"], other_front(other["state"]))), key=len)
        if both:
            looked += 1
            named = [one["uniforms"], other["uniforms"]]
            lost: list[str] = []
            for side, (a, b) in enumerate(((one, other), (other, one))):
                if (a["loose"] or a["laid"]) and not b["laid"] and any(ZINK.match(name) for name in b["uniforms"]):
                    theirs, lost = worded(a, b)
                    named = [{name: a["uniforms"][name] for name in theirs}, theirs][::1 - 2 * side] if theirs or lost else named
            found += [f"{name}: no such value on the other side" for name in lost]
            for name, values in uniform_differences(*named):
                told.add(f"{name}: {values}")
                found.append(f"{name}: {values}" if len(told) <= MOST_TOLD else "more uniforms")
                clocks |= {found[-1]} if CLOCK.search(name) else set()
            if all(named) and not common(*named) and not any(map(made_up, named)):
                sides = (", ".join(f"{name} {text_of(plain(values)[0])}" for name, values in [*uniforms.items()][:MOST_TOLD])
                         for uniforms in named)
                found.append("uniforms of other names, which are not compared: " + " against ".join(sides))
            found += [f"sampler of {name}: {a} against {b}" for name, a, b in common(one["samplers"], other["samplers"]) if a != b]
            numbers = stream_differences(one["streams"], other["streams"], folders, ported)
            found += numbers
            details = {**numbers, **details}
        for text in dict.fromkeys(found):
            draws.setdefault(text, []).append(at)
    for text, places in draws.items():
        more = f" and {len(places) - 1} more" if len(places) > 1 else ""
        part = f" (draw {places[0] + 1}{more} of {first['draws']})" if len(places) < looked else " (in all draws)" if places[0] < 0 else ""
        detail = f": {details[text]}" if text in details else ""
        (moved if text in clocks else texts).append(text + detail + part)
    for one, other in zip(first["shaders"], second["shaders"]) if not ported else ():
        if one["file"] != other["file"]:
            texts.append(f"{one['stage']} shader: other code, see --save")
    return texts, moved, compared
