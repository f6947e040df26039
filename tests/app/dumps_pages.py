"""Reads what `compare plain ulp late` wrote: page/, strips/ and xml, of --html, --pictures and --junit."""
import glob
import os
import re
import xml.etree.ElementTree

import report

text = open("page/index.html", encoding="utf-8").read()
page = report.Page(text)
pictures = [e[1]["src"] for e in page.all("img")]
assert len(pictures) == len(set(pictures)) == 2 * 4 and all(os.path.exists("page/" + name) for name in pictures), pictures
assert "Why: radiance: equal after a flip in y" in text and "First pass that differs: light: resource radiance" in text
assert [e[2] for e in page.all("td") if "DIFFERS" in e[1].get("class", "")] == ["DIFFERS", "DIFFERS"]
assert "<dt>Frame</dt>" not in text and "plain and ulp agree" in text
assert re.search(r'<td class="word within">within</td><td>[0-9]*</td><td>[0-9]*</td><td>100 %</td>', text)
assert sorted(os.path.basename(name) for name in glob.glob("strips/*")) == ["00.gbuffer.depth.ulp.png", "01.light.radiance.late.png"]
agree, differ = xml.etree.ElementTree.parse("xml").getroot().findall("testsuite")
assert (agree.get("name"), agree.get("tests"), agree.get("failures")) == ("ulp against plain", "3", "0")
assert (differ.get("name"), differ.get("tests"), differ.get("failures")) == ("late against plain", "3", "2")
failed = {case.get("name"): case.find("failure").get("message") for case in differ.findall("testcase") if case.find("failure") is not None}
assert list(failed) == ["radiance", "bins"] and "; equal after a flip in y" in failed["radiance"], failed
