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


def look(path, scheme):
    """The harness stands beside the page, for its relative links; a frame is as wide as a phone, which a window cannot be."""
    with open(path, encoding="utf-8") as file:
        page = re.sub(r"<meta http-equiv=\"Content-Security-Policy\".*?>", "", file.read())  # it would stop the harness's script
    with open(os.path.join(os.path.dirname(__file__), "pages.js"), encoding="utf-8") as file:
        script = file.read()
    harness = os.path.join(os.path.dirname(path), "harness.html")
    with open(harness, "w", encoding="utf-8") as file:
        file.write(f"<!DOCTYPE html><meta charset=utf-8><meta name=color-scheme content='light dark'><body><script>{script}</script>"
                   + "".join(f"<iframe style='border: 0' width={width} height=800 srcdoc=\"{html.escape(page)}\"></iframe>" for width in WIDTHS))
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run(["chromium", *FLAGS, f"--user-data-dir={profile}", "--window-size=2600,1000",
                               f"--blink-settings=preferredColorScheme={0 if scheme == 'dark' else 1}", "--dump-dom",
                               "file://" + os.path.abspath(harness)], capture_output=True, text=True, check=False, timeout=600)
    os.unlink(harness)
    said = re.search(r'<pre id="said">looked at\n?(.*?)</pre>', done.stdout, re.DOTALL)
    return [line for line in html.unescape(said[1]).splitlines() if line] if said else ["not looked at", done.stderr[-2000:]]


def main():
    wrong = [line for scheme in sys.argv[2:] for line in look(sys.argv[1], scheme)]
    print("\n".join(wrong[:100]))
    return bool(wrong)


sys.exit(main())
