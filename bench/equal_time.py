#!/usr/bin/env python3
"""Error over processor time of the methods of visibility: renders, compares with a reference, prints a table, draws an SVG.

    python3 bench/equal_time.py build/ci/pentaprism --json new.json -o docs/images/equal-time.svg

Frame: fairy-forest with both blurs, 1280x720, one thread; other words for `pentaprism render` may be given after `--`. Error: root
mean square of sRGB-encoded values (`pentaprism compare`) against --reference samples per pixel of another seed. Time: that of the whole
program, user and system, and of it visibility alone. Last comes what each method takes for the error of `stochastic` at 16 samples per pixel
(powers between the measured counts).
"""
import argparse
import json
import math
import pathlib
import resource
import subprocess
import sys
import tempfile

FRAME = "builtin:fairy-forest -r 1280x720 --frame 24 --fstop 2 --shutter 1".split()
METHODS = {"stochastic": "#0072b2", "interleaved": "#009e73", "accumulation": "#d55e00", "raytrace": "#777777"}
WIDTH, HEIGHT, LEFT, TOP, BOTTOM = 560, 380, 64, 24, 44


def processor_seconds(command):
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before = used()
    subprocess.run(command, check=True)
    return used() - before


def measure(program, frame, counts, reference_spp, repeats):
    folder = pathlib.Path(tempfile.mkdtemp())
    reference, picture, stats = folder / "reference.exr", folder / "picture.exr", folder / "stats.json"
    subprocess.run([program, "render", *frame, "-o", reference, "-q", "-s", str(reference_spp), "--seed", "77"], check=True)
    rows = []
    for spp in counts:
        for method in METHODS:
            command = [program, "render", *frame, "-o", picture, "--overwrite", "-q", "-t", "1", "-s", str(spp), "--visibility", method]
            seconds, visibility = float("inf"), float("inf")
            for _ in range(repeats):
                seconds = min(seconds, processor_seconds([*command, "--stats", stats]))
                visibility = min(visibility, json.loads(stats.read_text())["times_ms"]["visibility"])
            told = subprocess.run([program, "compare", "--json", picture, reference], check=True, capture_output=True, text=True)
            rows.append({"method": method, "spp": spp, "seconds": seconds, "visibility_ms": visibility,
                         "rmse": json.loads(told.stdout)["rmse"]})
            print(f"| {method} | {spp} | {seconds:.2f} | {visibility:.0f} | {rows[-1]['rmse']:.5f} |", flush=True)
    return rows


def at_error(rows, method, error, what):
    """Of `what` where the method's error is that: powers between two counts; beyond the last one as from the last two."""
    own = sorted((r for r in rows if r["method"] == method and what in r), key=lambda r: r["spp"])
    if len(own) < 2:
        return None
    for first, second in zip(own, own[1:]):
        if second["rmse"] <= error:
            break
    share = math.log(error / first["rmse"]) / math.log(second["rmse"] / first["rmse"])
    return math.exp(math.log(first[what]) + share * math.log(second[what] / first[what]))


def print_equal_error(rows, spp=16):
    error = next((r["rmse"] for r in rows if r["method"] == "stochastic" and r["spp"] == spp), None)
    if error is None:
        return
    print(f"\n| method, for an error of {error:.5f} | samples per pixel | s | visibility, ms |\n|---|---:|---:|---:|")
    for method in METHODS:
        spp_then, seconds, visibility = (at_error(rows, method, error, k) for k in ("spp", "seconds", "visibility_ms"))
        if seconds is not None:
            print(f"| {method} | {spp_then:.1f} | {seconds:.2f} | {f'{visibility:.0f}' if visibility else ''} |")


def ticks(low, high):
    steps = [m * 10.0**e for e in range(-4, 5) for m in (1, 2, 3, 5)]
    return [s for s in steps if low * 0.999 <= s <= high * 1.001]


def draw(rows, path):
    x0, x1 = (f(r["seconds"] for r in rows) for f in (min, max))
    y0, y1 = (f(r["rmse"] for r in rows) for f in (min, max))
    x0, x1, y0, y1 = x0 / 1.1, x1 * 1.1, y0 / 1.1, y1 * 1.15
    place_x = lambda x: LEFT + (WIDTH - LEFT - 20) * math.log(x / x0) / math.log(x1 / x0)
    place_y = lambda y: TOP + (HEIGHT - TOP - BOTTOM) * (1 - math.log(y / y0) / math.log(y1 / y0))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="12">',
           '<rect width="100%" height="100%" fill="white"/>']
    for y in ticks(y0, y1):
        out.append(f'<path d="M{LEFT} {place_y(y):.1f}H{WIDTH - 20}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 6}" y="{place_y(y) + 4:.1f}" text-anchor="end">{y:g}</text>')
    for x in ticks(x0, x1):
        out.append(f'<path d="M{place_x(x):.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#eee"/>')
        out.append(f'<text x="{place_x(x):.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{x:g}</text>')
    out.append(f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 8}" text-anchor="middle">processor time, s</text>')
    out.append(f'<text x="{LEFT}" y="15">root mean square error, sRGB-encoded; numbers: samples per pixel</text>')
    for row, (method, colour) in enumerate(METHODS.items()):
        own = [(place_x(r["seconds"]), place_y(r["rmse"]), r["spp"]) for r in rows if r["method"] == method]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y, _ in own)
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for x, y, spp in own:
            out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>')
            if method in ("stochastic", "raytrace"):
                out.append(f'<text x="{x + 5:.1f}" y="{y - 5:.1f}" font-size="10" fill="{colour}">{spp}</text>')
        out.append(f'<text x="{WIDTH - 24}" y="{TOP + 18 + 16 * row}" text-anchor="end" fill="{colour}">{method}</text>')
    path.write_text("\n".join([*out, "</svg>"]) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("-o", "--output", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path, help="write (or, if it is there, read) what was measured")
    parser.add_argument("--samples", type=int, nargs="+", default=[4, 8, 16, 32, 64])
    parser.add_argument("--reference", type=int, default=1024)
    parser.add_argument("--repeats", type=int, default=1, help="the least time counts")
    # argparse takes what follows `--` only where no option stands before it.
    words = sys.argv[1:]
    own, frame = (words[: words.index("--")], words[words.index("--") + 1 :]) if "--" in words else (words, FRAME)
    arguments = parser.parse_args(own)
    if arguments.json and arguments.json.exists():
        rows = json.loads(arguments.json.read_text())
    else:
        rows = measure(arguments.program, frame, arguments.samples, arguments.reference, arguments.repeats)
        if arguments.json:
            arguments.json.write_text("[\n" + ",\n".join(json.dumps(r) for r in rows) + "\n]\n")
    print_equal_error(rows)
    if arguments.output:
        draw(rows, arguments.output)


if __name__ == "__main__":
    main()
