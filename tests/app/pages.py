"""Looks at a page as a reader does, in Chromium without a window: pages.py PAGE.html light|dark... Prints what is wrong (pages.js)."""
import html
import os
import re
import subprocess
import sys
import tempfile

FLAGS = ("--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking --hide-scrollbars "
         "--disable-component-update --disable-sync --allow-file-access-from-files --virtual-time-budget=20000").split()


WIDTHS = (390, 1280, 2560)  # a phone, a usual and a large screen


def look(path, schemes):
    """The harness stands beside the page, for its relative links; a frame is as wide as a phone, which a window cannot be, and its
    colour scheme is what the page prefers."""
    with open(path, encoding="utf-8") as file:
        page = re.sub(r"<meta http-equiv=\"Content-Security-Policy\".*?>", "", file.read())  # it would stop the harness's script
    with open(os.path.join(os.path.dirname(__file__), "pages.js"), encoding="utf-8") as file:
        script = file.read()
    harness = os.path.join(os.path.dirname(path), "harness.html")
    with open(harness, "w", encoding="utf-8") as file:
        file.write(f"<!DOCTYPE html><meta charset=utf-8><meta name=color-scheme content='light dark'><body><script>{script}</script>"
                   + "".join(f"<iframe name='{width} {scheme}' style='border: 0; color-scheme: {scheme}' width={width} height=800 "
                             f"srcdoc=\"{html.escape(page)}\"></iframe>" for scheme in schemes for width in WIDTHS))
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run(["chromium", *FLAGS, f"--user-data-dir={profile}", "--window-size=2600,1000", "--dump-dom",
                               "file://" + os.path.abspath(harness)], capture_output=True, text=True, check=False, timeout=600)
    os.unlink(harness)
    said = re.search(r'<pre id="said">looked at\n?(.*?)</pre>', done.stdout, re.DOTALL)
    return [line for line in html.unescape(said[1]).splitlines() if line] if said else ["not looked at", done.stderr[-2000:]]


def main():
    wrong = look(sys.argv[1], sys.argv[2:])
    print("\n".join(wrong[:100]))
    return bool(wrong)


sys.exit(main())
