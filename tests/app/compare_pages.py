"""Reads what compare wrote for a fault that changes the four half floats of a texel of `denoise_columns.indirect` in rsm:
compare_pages.py FOLDER JUNIT LIST, of --html, --junit and list --json."""
import json
import os
import re
import sys
import urllib.parse
import xml.etree.ElementTree

import report

folder, junit, pipeline = sys.argv[1:]
with open(pipeline, encoding="utf-8") as file:
    pipeline = json.load(file)
rows = [name for entry in pipeline["passes"] for name in entry["writes"]]
kept = [resource["name"] for resource in pipeline["resources"] if resource["history"]]  # compared before the first pass, too
images = {resource["name"] for resource in pipeline["resources"] if resource["kind"] == "image"}

with open(folder + "/index.html", encoding="utf-8") as file:
    text = file.read()
page = report.Page(text)
ids = {e[1]["id"] for e in page.elements if "id" in e[1]}
links = [e[1][name] for e in page.elements for name in ("src", "href") if name in e[1]]
assert len(links) > 25 and "://" not in text and "url(" not in text.replace("url(#false)", "")
for link in links:
    name = urllib.parse.unquote(link)
    assert name[1:] in ids if name.startswith("#") else os.path.exists(os.path.join(folder, name)), link
pictures = [e for e in page.all("img") if "indirect" in e[1]["src"].split(".")]
assert [re.sub(r".*indirect\.", "", e[1]["src"]) for e in pictures] == ["1.png", "2.png", "difference.png"]
assert len(page.all("img")) == 2 + sum(name in images for name in rows), "of the other images one each: buffers have none"
verdicts = [e[2] for e in page.all("td") if "DIFFERS" in e[1].get("class", "")]
assert verdicts == ["DIFFERS"]
assert "Guilty: pass denoise_columns (shader shared/denoise_columns.glsl): resource indirect, in frame 0." in text
guilty = next(i for i, name in enumerate(rows) if name == "indirect")
assert f'in frame 0. <a href="#r0-{guilty}">Show it</a>' in text, "the verdict leads to the guilty pass"
heads = [e[2] for e in page.all("th")]
assert heads[heads.index("Verdict"):] == ["Verdict", "Differing", "Elements", "Of bound", "Inputs", "Own error", "Largest error"], heads
(row,) = re.findall(r'<tr>(?:(?!</tr>).)*DIFFERS.*?</tr>', text)
assert "<td class=\"word\">equal</td><td class=\"word\">1 differ</td>" in row, row
assert text.count('class="stop"') == 1, "j leads to what differs"
heights = re.search(r'<div class="bins">(.*?)</div>', text, re.DOTALL)[1]
assert re.findall(r"<span>([^<]*)</span>.*<b>([0-9]*)</b>", heights) == [("8192 to 16383", "4")], heights

suites = xml.etree.ElementTree.parse(junit).getroot()
(suite,) = suites.findall("testsuite")
cases = suite.findall("testcase")
assert suite.get("name") == "rsm: vk against gl" and int(suite.get("tests")) == len(cases) == len(rows) + len(kept)
failed = [case for case in cases if case.find("failure") is not None]
assert [(case.get("classname"), case.get("name")) for case in failed] == [("denoise_columns", "indirect")]
assert suite.get("failures") == "1" and "1 of 135 differ; 1 at " in failed[0].find("failure").get("message")
assert {item.get("name") for item in suite.iter("property")} == {"gl", "vk"}
