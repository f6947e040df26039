"""Line plots by matplotlib: NAME.svg, which follows a dark page, and its numbers beside it, NAME.csv."""
from __future__ import annotations

import csv
import dataclasses
import io
import math
import os
from typing import Any

from .console import write

WIDTH, HEIGHT, KEY_LINE = 480, 340, 17  # pixels
COLOURS = ["#2f80d0", "#d9771a", "#2c9c6c", "#a963c9", "#d34a4a", "#8a8f98"]
DASHES: list[Any] = ["-", "--", ":", "-.", (0, (6, 2, 1, 2, 1, 2))]
MARKS = ["o", "s", "^", "v", "D", "x"]
# Text takes the page's colour; lines and frame are visible on both.
STYLE = "<style>text{fill:#24292f}@media(prefers-color-scheme:dark){text{fill:#d6dce3}}</style>\n"


@dataclasses.dataclass
class Line:
    """Points at x; NaN leaves one out. `bars`: from low to high at each point."""

    title: str
    points: list[tuple[float, float]]
    colour: int = 0
    dash: int = 0
    bars: list[tuple[float, float]] = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Plot:
    """`values`: of the x axis, where it is a list: numbers stand at their value, on a logarithmic axis where they span a factor
    of 4; other words side by side. `from_zero`: the y axis; else it is logarithmic. `noise`: a grey band from 0 to it, or for a
    ratio from 1 / it to it. `beside`: the key stands right of the plot."""

    x_label: str
    y_label: str
    values: list[str]
    lines: list[Line]
    from_zero: bool = False
    noise: float = 0
    noise_is_ratio: bool = False
    beside: bool = False

    def height(self) -> int:
        return max(HEIGHT, len(self.lines) * (KEY_LINE + 1) + 60) if self.beside else HEIGHT + KEY_LINE * max(0, len(self.lines) - 4)


def places(values: list[str]) -> list[float]:
    """Where the values stand on the x axis."""
    try:
        numbers = [float(value) for value in values]
    except ValueError:
        numbers = [math.nan]
    return numbers if all(map(math.isfinite, numbers)) else [float(i) for i in range(len(values))]


def shown(plot: Plot) -> list[float]:
    """The numbers that can be seen."""
    numbers = [y for line in plot.lines for _, y in line.points]
    return [y for y in numbers if math.isfinite(y) and (plot.from_zero or y > 0)]


def set_axes(plot: Plot, axes: Any) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter, NullLocator, StrMethodFormatter

    at = places(plot.values)
    if at and min(at) > 0 and max(at) >= 4 * min(at):
        axes.set_xscale("log")
    if at:
        axes.set_xticks(at, plot.values)
        axes.xaxis.set_minor_locator(NullLocator())
        axes.margins(x=0.06)
    if plot.from_zero:
        axes.set_ylim(bottom=0)
    else:
        numbers = shown(plot) + ([plot.noise] if plot.noise > 0 else [])
        low, high = min(numbers) / 1.6, max(numbers) * 1.6
        axes.set_yscale("log")
        axes.set_ylim(low, high)
        ticks = (1, 2, 5, 1.5, 3, 7) if high < 10 * low else (1, 2, 5) if high < 1000 * low else (1,)
        axes.yaxis.set_major_locator(LogLocator(subs=ticks))
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
    if plot.noise > 0:
        low = 1 / plot.noise if plot.noise_is_ratio else axes.get_ylim()[0]
        axes.axhspan(low, plot.noise, color="#808080", alpha=0.2, lw=0, gid="noise")


def add_lines(plot: Plot, axes: Any) -> None:
    """Each line is thinner than those before it, which are seen on both sides of it where they coincide."""
    last = max(1, len(plot.lines) - 1)
    for index, line in enumerate(plot.lines):
        x, y = ([point[i] for point in line.points] for i in (0, 1))
        width = 1 + 2 * (last - index) / last
        colour = line.colour % len(COLOURS)
        axes.plot(x, y, color=COLOURS[colour], ls=DASHES[line.dash % len(DASHES)], marker=MARKS[colour], lw=width, ms=2 + width,
                  label=line.title.replace("$", r"\$"))
        if line.bars:
            axes.vlines(x, *zip(*line.bars), color=COLOURS[colour], lw=1)


def draw(plot: Plot, folder: str, name: str) -> bool:
    """Writes NAME.svg and NAME.csv into the folder; a plot without points has no SVG. Whether it has one."""
    path = os.path.join(folder, name)
    table = io.StringIO()
    bars: list[list[Any]] = [list(line.bars) or [()] * len(line.points) for line in plot.lines]
    rows = [(line.title, *point, *bar) for line, around in zip(plot.lines, bars) for point, bar in zip(line.points, around)]
    csv.writer(table, lineterminator="\n").writerows([("line", plot.x_label, plot.y_label, "low", "high"), *rows])
    write(path + ".csv", table.getvalue())
    if not shown(plot):
        if os.path.exists(path + ".svg"):
            os.unlink(path + ".svg")
        return False
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot

    frame = {"axes.edgecolor": "#8a8f98", "xtick.color": "#8a8f98", "ytick.color": "#8a8f98", "grid.color": "#8a8f98"}
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": name, "font.size": 9, "axes.spines.top": False,
                                "axes.spines.right": False, **frame}):
        width = 2 * WIDTH if plot.beside else WIDTH
        figure, axes = pyplot.subplots(figsize=(width / 96, plot.height() / 96), dpi=96, layout="constrained")
        axes.set_xlabel(plot.x_label.replace("$", r"\$"))
        axes.set_ylabel(plot.y_label)
        axes.grid(axis="y", lw=0.4)
        add_lines(plot, axes)
        set_axes(plot, axes)
        place: Any = {"loc": "upper left", "bbox_to_anchor": (1, 1)} if plot.beside else {"loc": "lower left", "bbox_to_anchor": (0, 1)}
        axes.legend(frameon=False, **place)
        text = io.StringIO()
        figure.savefig(text, format="svg", transparent=True, metadata={"Date": None})
        pyplot.close(figure)
    svg = text.getvalue()
    end = svg.index(">", svg.index("<svg")) + 1
    write(path + ".svg", svg[:end] + STYLE + svg[end:])
    return True
