#!/usr/bin/env python3
"""How many updates a second streams get, by their number and by the size of their mesh.

Usage: tests/bench/streams.py [--bin FOLDER] [--seconds S] [--streams N,...] [--vertices N,...] [--svg FILE] [--json FILE]

Runs a private arapd from FOLDER (build/release/bin) on a unix socket and `arapctl load` against it, a closed loop
with one update of each stream on its way, and before each the transport by itself with messages of the same sizes.
Prints two tables for docs/performance.md and draws them with --svg. Generator and server share the machine: the
figures mean something where nothing else runs.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

# Vertices of all streams: each stream keeps a workspace, and an owner has 4 GiB.
MOST = 4_000_000
COLOURS = ["#7a4a1d", "#c0662b", "#2f7d5b", "#2b6cb0", "#7b4fa6", "#b03a5b"]


def numbers(text):
    return [int(part) for part in text.split(",")]


def named(count):
    return f"{count // 1000}k" if count >= 1000 else str(count)


def measure(folder, arguments, vertices, streams):
    """One run: updates and echoes a second, and medians in microseconds."""
    # Long enough for several rounds of all streams.
    seconds = arguments.seconds * max(1, vertices * streams / 500_000)
    with tempfile.TemporaryDirectory() as place:
        address = f"unix:{place}/s"
        server = subprocess.Popen(
            [f"{folder}/arapd", "--listen", address, "--store", "memory", "--no-admin", "--log-level", "warn",
             "--echo", "--max-streams-per-owner", "1000", "--max-stream-load", "0", "--max-stream-fps", "1000000"],
            stdout=subprocess.PIPE, text=True)
        try:
            server.stdout.readline()
            subprocess.run(
                [f"{folder}/arapctl", "load", "--server", address, "--quiet", "--sessions", "1",
                 "--streams", str(streams), "--vertices", str(vertices), "--seconds", str(seconds),
                 "--warm-up", str(seconds / 3), "--transport", str(arguments.seconds / 2),
                 "--json", f"{place}/json"],
                check=True, stdout=subprocess.DEVNULL)
            with open(f"{place}/json", encoding="utf-8") as file:
                told = json.load(file)
        finally:
            server.terminate()
            server.wait()
    return {
        "vertices": told["vertices"],
        "streams": streams,
        "rate": told["updates_per_second"],
        "p50": told["round_trip_micros"]["p50"],
        "p99": told["round_trip_micros"]["p99"],
        "solve": told["solve_micros"]["p50"],
        "echo_rate": told["transport"]["per_second"],
        "echo_p50": told["transport"]["round_trip_micros"]["p50"],
    }


def table(rows, columns, cell):
    """A Markdown table: a row for each size of mesh, a column for each number of streams."""
    text = "| vertices | " + " | ".join(f"{count} streams" if count > 1 else "1 stream" for count in columns) + " |\n"
    text += "|---|" + "---|" * len(columns) + "\n"
    for vertices, runs in rows.items():
        cells = [cell(runs[count]) if count in runs else "–" for count in columns]
        text += f"| {vertices:,} | " + " | ".join(cells) + " |\n"
    return text


class Panel:
    """A chart with logarithmic axes."""

    def __init__(self, left, title, columns, low, high):
        self.left, self.top, self.width, self.height = left, 60, 390, 330
        self.columns, self.low, self.high = columns, math.floor(math.log10(low)), math.ceil(math.log10(high))
        self.parts = [f'<text x="{left}" y="36" font-size="16" font-weight="bold">{title}</text>']
        for power in range(self.low, self.high + 1):
            y = self.y(10.0**power)
            self.parts.append(f'<path d="M{left} {y:.1f}h{self.width}" stroke="#ddd6c8"/>')
            self.parts.append(f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{self.label(power)}</text>')
        for count in columns:
            x = self.x(count)
            self.parts.append(f'<path d="M{x:.1f} {self.top}v{self.height}" stroke="#ece6da"/>')
            self.parts.append(
                f'<text x="{x:.1f}" y="{self.top + self.height + 20}" text-anchor="middle">{count}</text>')
        self.parts.append(f'<text x="{left + self.width / 2}" y="{self.top + self.height + 42}" '
                          'text-anchor="middle">streams</text>')
        self.names = []

    @staticmethod
    def label(power):
        return f"{10**power:,}" if power >= 0 else f"{10.0**power:g}"

    def x(self, count):
        first, last = math.log2(self.columns[0]), math.log2(self.columns[-1])
        return self.left + self.width * (math.log2(count) - first) / (last - first)

    def y(self, value):
        part = (math.log10(value) - self.low) / (self.high - self.low)
        return self.top + self.height * (1 - part)

    def line(self, values, colour, name, dashed=False):
        points = [(self.x(count), self.y(value)) for count, value in values.items()]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="2"{dash}/>')
        for x, y in points if not dashed else []:
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>')
        self.names.append((*points[-1], colour, name))

    def svg(self):
        last, text = -math.inf, ""
        for x, y, colour, name in sorted(self.names, key=lambda one: one[1]):
            if x < self.left + self.width:
                # Above the end of its line: beside it other lines go on. Further from it where longer lines have theirs.
                before = 12 * sum(self.x(count) > x for count in self.columns)
                text += f'<text x="{x - before:.1f}" y="{y - 10:.1f}" text-anchor="end" fill="{colour}">{name}</text>\n'
                continue
            last = max(y, last + 15)
            text += f'<text x="{x + 8:.1f}" y="{last + 4:.1f}" fill="{colour}">{name}</text>\n'
        return "\n".join(self.parts) + "\n" + text


def draw(rows, columns):
    runs = [run for row in rows.values() for run in row.values()]
    rate = Panel(90, "updates a second", columns, min(run["rate"] for run in runs),
                 max(run["echo_rate"] for run in runs))
    trip = Panel(690, "median round trip, milliseconds", columns,
                 min(run["echo_p50"] for run in runs) / 1000, max(run["p50"] for run in runs) / 1000)
    for colour, (vertices, row) in zip(COLOURS, rows.items()):
        name = f"{vertices:,} vertices"
        rate.line({count: run["rate"] for count, run in row.items()}, colour, name)
        trip.line({count: run["p50"] / 1000 for count, run in row.items()}, colour, name)
    thousand = min(rows, key=lambda vertices: abs(math.log(vertices / 1000)))
    name = f"echo of {thousand:,}"
    rate.line({count: rows[thousand][count]["echo_rate"] for count in columns}, "#888888", name, True)
    trip.line({count: rows[thousand][count]["echo_p50"] / 1000 for count in columns}, "#888888", name, True)
    return ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1210 460" width="1210" height="460" '
            'font-family="sans-serif" font-size="13" fill="#333333">\n'
            '<rect width="100%" height="100%" fill="#fbf9f5"/>\n' + rate.svg() + trip.svg() + "</svg>\n")


def main():
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=f"{root}/build/release/bin", metavar="FOLDER")
    parser.add_argument("--seconds", type=float, default=3)
    parser.add_argument("--streams", type=numbers, default=[1, 2, 4, 16, 64, 256], metavar="N,...")
    parser.add_argument("--vertices", type=numbers, default=[100, 1000, 10000, 50000, 200000], metavar="N,...")
    parser.add_argument("--svg", metavar="FILE")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--from-json", metavar="FILE", help="tables and picture of an earlier run")
    arguments = parser.parse_args()
    if arguments.from_json:
        with open(arguments.from_json, encoding="utf-8") as file:
            runs = json.load(file)
    else:
        runs = []
        for vertices in arguments.vertices:
            for streams in arguments.streams:
                if vertices * streams > MOST:
                    continue
                print(f"{named(vertices)} vertices, {streams} streams", file=sys.stderr)
                runs.append(measure(arguments.bin, arguments, vertices, streams))
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(runs, file, indent=1)
    rows = {}
    for run in runs:
        rows.setdefault(run["vertices"], {})[run["streams"]] = run
    columns = sorted({run["streams"] for run in runs})
    print("Updates a second, and which part that is of echoes of the same sizes:\n")
    print(table(rows, columns, lambda run: f"{run['rate']:,.0f} ({100 * run['rate'] / run['echo_rate']:.0f} %)"))
    print("Median and 99 % of the round trips in milliseconds, and the median of the echoes':\n")
    print(table(rows, columns, lambda run: f"{run['p50'] / 1000:.3g} / {run['p99'] / 1000:.3g} "
                                           f"({run['echo_p50'] / 1000:.3g})"))
    if arguments.svg:
        with open(arguments.svg, "w", encoding="utf-8") as file:
            file.write(draw(rows, columns))


if __name__ == "__main__":
    main()
