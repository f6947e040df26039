"""Checks the page of a report: report.py FOLDER [--incomplete].
Checks the page of a bundle's run, and one verdict in it: report.py --collected FOLDER VERDICT.

Every tag is closed, every link and picture leads to a file, and nothing comes from a network. Every number equals that in the
JSON file that the page names for it, or follows from that file. With --incomplete the last value of the sweep and the first
picture must have failed."""
import csv
import html.parser
import json
import os
import re
import sys
import urllib.parse

VOID = {"meta", "img", "br", "link", "hr", "input"}
SCENE, FOLDER = "a & box", "a___box"
VALUES = ["0.05", "0.1", "0.2"]
PICTURES = ["dark", "shown"]
MOTION = "t___n"
HEADLINES = [("relative MSE", "hdr.relative_mse"), ("SMAPE", "hdr.smape"), ("FLIP", "ldr.flip.mean"), ("mean / reference", "hdr.ratio"),
             ("darker than 1/5", "hdr.darker"), ("brighter than 5 times", "hdr.brighter")]


def error_file(picture, value, ending=""):
    """Errors of the first backend's picture at a value of the sweep; with the ending own, against the last value."""
    return f"{FOLDER}/48x27_picture_{picture}_level_{value}_gl.{ending or 'metrics'}.json"


def bench_file(value):
    """Times of the last picture at a value of the sweep."""
    return f"{FOLDER}/48x27_picture_shown_level_{value}.bench.json"


class Page(html.parser.HTMLParser):
    """Elements in the order of the page: tag, attributes, text of the whole element."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.elements = [], []
        self.feed(text)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attrs):
        assert len(dict(attrs)) == len(attrs), f"an attribute twice: {attrs}"
        element = [tag, dict(attrs), ""]
        self.elements.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_endtag(self, tag):
        assert self.open and self.open[-1][0] == tag, f"</{tag}> closes {self.open and self.open[-1][0]}"
        self.open.pop()

    def handle_data(self, data):
        for element in self.open:
            element[2] += data

    def all(self, tag):
        return [e for e in self.elements if e[0] == tag]


def near(text, number, what):
    """Asserts that a text shows a number with three digits, or as an integer."""
    shown = float(text)
    assert abs(shown - number) <= 0.006 * abs(number) or abs(shown - number) < 0.5 <= 100 <= number, f"{what}: {text} for {number}"


def follow(value, path):
    for name in path.split("."):
        value = value[name]
    return value


def check_links(page, folder):
    ids = [e[1]["id"] for e in page.elements if "id" in e[1]]
    assert len(ids) == len(set(ids)) and not any(" " in i for i in ids), ids
    links = [e[1][name] for e in page.elements for name in ("src", "href") if name in e[1]]
    assert len(links) > 6, links
    for link in links:
        assert not urllib.parse.urlparse(link).scheme and not set(link) & set(" <>&"), f"{link}: not of this folder"
        path = urllib.parse.unquote(link)
        if path.startswith("#"):
            assert path[1:] in ids, path
        else:
            assert os.path.getsize(os.path.join(folder, path)) > 0
    # the page lays any two pictures on each other: at first the last picture on the reference
    choices = [(e[2], e[1]["value"], "selected" in e[1]) for e in page.all("option")]
    for _, file, _ in choices:
        assert os.path.getsize(os.path.join(folder, urllib.parse.unquote(file))) > 0
    stack = [e[1]["src"] for e in page.all("img") if e[1]["alt"].endswith((", left picture", ", right picture"))]
    half = len(choices) // 2
    assert choices[half - 1][0] == choices[-1][0] and choices[-1][2] and not choices[half - 1][2], choices
    assert stack == [next(c[1] for c in choices[:half] if c[2]), choices[-1][1]] and stack[0] != stack[1], (stack, choices)
    for _, attributes, _ in page.all("img"):
        assert len(attributes["alt"]) > 5 and attributes["width"] and attributes["height"], attributes


def check_numbers(page, results, missing, values):
    marked = page.all("data")
    # the headlines in the overview and under each of two pictures, if they are there; samples; two of the map; a table of each
    # headline and one against the last value, two pictures each
    shown = 2 - (f"{FOLDER}/dark.metrics.json" in missing)
    # and four of each run of the motion, and of the noise
    headlines = len(HEADLINES)
    assert len(marked) == headlines * (2 + shown) + 1 + 2 + 2 * (headlines + 1) * len(values) + 3 * 4, len(marked)
    for _, attributes, text in marked:
        file, path = attributes["value"].split("#")
        if file in missing:
            assert text == "\u2013", (file, text)
        else:
            scale = 100 if text.endswith("\u00a0%") else 1
            near(text.removesuffix("\u00a0%"), scale * follow(results[file], path), attributes["value"])
    assert {e[1]["value"].split("#")[0] for e in marked} == (set(results) | set(missing)) - {
        f"{FOLDER}/all.compare.json"} - {f for f in set(results) | set(missing) if f.endswith(".bench.json")}


def table_rows(page, caption):
    """The cells of the table whose caption begins with `caption`, row by row."""
    text = next(e[2] for e in page.all("table") if e[2].strip().startswith(caption))
    assert text
    rows, inside = [], False
    for tag, _, words in page.elements:
        if tag == "table":
            inside = words == text
        elif inside and tag == "tr":
            rows.append([])
        elif inside and tag in ("th", "td"):
            rows[-1].append(words)
    return rows


def stage_ms(result, side, passes):
    return sum(p["ms"]["median"] for p in result["sides"][side]["passes"] if p["pass"] in passes)


def check_stages(page, results, values):
    rows = table_rows(page, SCENE + ": milliseconds at 48x27")
    assert rows[0] == ["Stage", "level"] + values, rows[0]
    sides, ratios = ["gl", "vk"], ["somebody's paper", "gl / somebody's paper", "vk / somebody's paper"]
    assert [r[-1 - len(values)] for r in rows[1:]] == sides + ratios + sides + sides + ratios
    assert rows[1][0] == "Paint & conothing <else>"
    assert [float(x) for x in rows[3][-3:]] == [1.5, 2.5, 3.5] and [float(x) for x in rows[10][-3:]] == [4.5, 5.5, 6.5], rows
    for i, value in enumerate(values):
        result = results.get(bench_file(value))
        if not result:
            assert all(rows[r][i - len(values)] == "\u2013" for r in (1, 2, 4, 5, 6, 7, 8, 9, 11, 12))
            continue
        for side in (0, 1):
            assert result["sides"][side]["frame_ms"]["count"] == 3
            near(rows[1 + side][i - len(values)], stage_ms(result, side, ["paint"]), "paint")
            near(rows[4 + side][i - len(values)], stage_ms(result, side, ["paint"]) / (1.5 + i), "paint by the paper's")
            near(rows[6 + side][i - len(values)], stage_ms(result, side, ["show"]), "other passes")
            near(rows[8 + side][i - len(values)], result["sides"][side]["frame_ms"]["median"], "frame")
            near(rows[11 + side][i - len(values)], result["sides"][side]["frame_ms"]["median"] / (4.5 + i), "frame by the paper's")


def check_overview(page, results):
    rows = table_rows(page, "ScenePicture")
    assert len(rows) == 3 and rows[1][1] == "Dark, < 0.2"
    for row, name, level in ((rows[1], "dark", 0.1), (rows[2], "shown", 0.2)):
        if f"{FOLDER}/{name}.metrics.json" not in results:
            assert row[-len(HEADLINES):] == ["\u2013"] * len(HEADLINES)
            continue
        linear = results[f"{FOLDER}/{name}.metrics.json"]["hdr"]
        assert rows[0][2:] == [title for title, _ in HEADLINES], rows[0]
        for text, (title, path) in zip(row[-len(HEADLINES):], HEADLINES):
            near(text, follow(results[f"{FOLDER}/{name}.metrics.json"], path), title)
        near(row[-3], linear["mean_test"] / linear["mean_reference"], "ratio")
        # the picture is grey at that level, and exposed
        near(str(linear["mean_test"]), level * results[f"{FOLDER}/{name}.metrics.json"]["exposure"], name)


def check_motion(page, folder, results):
    """The grey picture does not change, so all changes of the reference count as flicker; two frames have one step."""
    for run in ("steady", "other"):
        result = results[f"{FOLDER}/{MOTION}/{run}.flicker.json"]
        assert len(result["per_frame"]) == 1 and result["change"] == 0 and result["block"] == 2, result
        assert 0 < result["flicker"] == result["change_reference"] == -result["excess"], result
    noise = results[f"{FOLDER}/{MOTION}/noise.flicker.json"]
    near(str(noise["mean_reference"]), result["mean_reference"], "the same reference")
    assert any("a & box: it <turns>" == e[2] for e in page.all("h3")) and not any("not here" == e[2] for e in page.all("h3"))
    rows = table_rows(page, "Means over all frames")
    assert [r[0] for r in rows[1:3]] == ["Steady", "Others' & more"], rows
    with open(os.path.join(folder, f"plots/motion_{FOLDER}_{MOTION}.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [r["frame"] for r in rows] == ["1"]
    assert "--from-bounce 0 --bounces 1 --quantity radiance" in page.elements[0][2]
    assert "radiance, the radiance, changes" in page.elements[0][2]
    for row, step in zip(rows, results[f"{FOLDER}/{MOTION}/other.flicker.json"]["per_frame"]):
        near(row["reference"], 100 * step["relative_change_reference"], "CSV")
        near(row["other"], 0, "CSV")
        near(row["other_flicker"], 100 * step["relative_flicker"], "CSV")


def check_csv(folder, results):
    """A row for each picture and value, of the first backend, and for the other where times are taken."""
    with open(os.path.join(folder, "rows.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    sides = {"dark": ["gl"], "shown": ["gl", "vk"]}
    assert [(r["picture"], r["level"], r["backend"]) for r in rows] == [
        (p, v, s) for p in PICTURES for v in VALUES for s in sides[p]], rows
    for row in rows:
        assert (row["scene"], row["width"], row["height"], row["status"], row["reason"]) == (SCENE, "48", "27", "done", ""), row
        result = results[error_file(row["picture"], row["level"])]
        own = results.get(error_file(row["picture"], row["level"], "own"))
        assert bool(own) == (row["level"] != VALUES[-1]), row
        if row["backend"] == "gl":
            near(row["relative_mse"], result["hdr"]["relative_mse"], "CSV")
            near(row["rmse"], result["hdr"]["rmse"], "CSV")
            near(row["psnr"], result["ldr"]["psnr"], "CSV")
            for _, path in HEADLINES:
                near(row[path.split(".")[1]], follow(result, path), "CSV")
        else:
            assert row["relative_mse"] == row["flip"] == row["own_flip"] == "", row
        assert bool(row["own_flip"]) == (bool(own) and row["backend"] == "gl"), row
        if row["own_flip"]:
            near(row["own_flip"], own["ldr"]["flip"]["mean"], "CSV")
        if row["picture"] == "dark":
            assert row["frame_ms"] == row["paint_ms"] == "", row
            continue
        side = results[bench_file(row["level"])]["sides"][row["backend"] == "vk"]
        for column, name in (("", "median"), ("_p5", "p5"), ("_p95", "p95")):
            near(row["frame_ms" + column], side["frame_ms"][name], "CSV")
            for run in side["passes"]:
                near(row[run["pass"] + "_ms" + column], run["ms"][name], "CSV")


def check_failures(folder):
    """The first picture and the last value have failed, and nothing else."""
    with open(os.path.join(folder, "rows.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 9, rows
    for row in rows:
        fails = row["picture"] == "dark" or row["level"] == "7"
        # without the last value, errors against that value are missing in all rows of the first backend
        assert row["status"] == "failed" if fails or row["backend"] == "gl" else row["status"] == "done", row
        assert ("level" in row["reason"]) == (row["status"] == "failed"), row
        assert bool(row["relative_mse"]) == (not fails and row["backend"] == "gl"), row


def check_collected(folder, verdict):
    with open(os.path.join(folder, "index.html"), encoding="utf-8") as file:
        page = Page(file.read())
    with open(os.path.join(folder, "post-cornell.bench.json"), encoding="utf-8") as file:
        sides = json.load(file)["sides"]
    assert len(sides) > 1
    cells = [e[2] for e in page.elements if e[0] in ("td", "th")]
    assert cells[0] == "post-cornell" and cells[1].startswith("vk@0, ") and verdict in cells[1], cells
    times = cells[-len(sides):]
    assert cells[-2 * len(sides) - 1:-len(sides)] == [side["side"] for side in sides] + ["post-cornell"], cells
    for side, cell in zip(sides, times):
        near(cell.split()[0], side["frame_ms"]["median"], side["side"])
        assert side["device"] in page.elements[0][2], side
    for link in page.all("a"):
        assert os.path.getsize(os.path.join(folder, link[1]["href"])) > 0
    assert "UTC" in page.elements[0][2] and "diptych " in page.elements[0][2]


def main():
    if sys.argv[1] == "--collected":
        return check_collected(*sys.argv[2:])
    folder, incomplete = sys.argv[1], "--incomplete" in sys.argv
    with open(os.path.join(folder, "index.html"), encoding="utf-8") as file:
        text = file.read()
    page = Page(text)
    values = ["0.05", "0.1", "7"] if incomplete else VALUES
    # the last value has no error against itself
    missing = [error_file(p, values[-1], "own") for p in PICTURES]
    if incomplete:
        missing += [f"{FOLDER}/dark.metrics.json", bench_file(7)]
        missing += [error_file("dark", v) for v in values] + [error_file("shown", 7)]
        missing += [error_file(p, v, "own") for p in PICTURES for v in ("0.05", "0.1")]
    names = ["reference.reference", "dark.metrics", "shown.metrics", "all.compare"]
    names += [f"{MOTION}/{n}.flicker" for n in ("steady", "other", "noise")]
    names = [f"{FOLDER}/{n}.json" for n in names] + [bench_file(v) for v in values]
    names += [error_file(p, v, e) for p in PICTURES for i, v in enumerate(values) for e in ["", "own"][:1 + (i + 1 < len(values))]]
    results = {}
    for name in names:
        if name not in missing:
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                results[name] = json.load(file)
    if incomplete:
        check_failures(folder)
    else:
        check_csv(folder, results)
    check_links(page, folder)
    check_numbers(page, results, missing, values)
    check_stages(page, results, values)
    check_overview(page, results)
    check_motion(page, folder, results)
    assert ("could not be made: " in page.elements[0][2]) == ("results, shown by a dash: " in page.elements[0][2]) == incomplete
    heads = {e[1].get("id"): e[2] for e in page.all("h2")}
    assert heads["pictures"] == "Picturessomebody's paper: Plate <1>" and heads["errors"] == "Error against level", heads
    assert [e[2] for e in page.all("h1")] == ['Grey & "plain" <all over>']
    assert re.search(r"Made\n?20\d\d-\d\d-\d\d, by diptych \d", page.elements[0][2])
    for words in ("Mesa", "absent: its mesh is not here", "agree on every resource", "Other hardware:", 'a "fast" device', "llvmpipe"):
        assert words in page.elements[0][2], words
    assert any("--set level=0.1" in e[2] for e in page.all("pre")) and any("pipeline: grey" in e[2] for e in page.all("pre"))


if __name__ == "__main__":
    main()
