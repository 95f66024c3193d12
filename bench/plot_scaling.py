#!/usr/bin/env python3
"""Draws what bench/scaling measured as one SVG and prints the exponents of time = constant * quantity ^ exponent.

    build/ci/bench/scaling 3 > scaling.json && python3 bench/plot_scaling.py scaling.json docs/develop/scaling.svg
"""
import json
import math
import sys

WIDTH, HEIGHT, MARGIN = 330, 260, 50
COLOURS = {"hand, defocus": "#0072b2", "car, motion": "#d55e00", "fairy-forest, both": "#009e73",
           "fairy-forest, motion": "#cc79a7", "fairy-forest, defocus": "#777777"}


def exponent(points):
    """Slope of a least-squares line through the logarithms; points at 0 are left out."""
    logs = [(math.log(x), math.log(y)) for x, y in points if x > 0]
    mx, my = (sum(v) / len(logs) for v in zip(*logs))
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, y in logs)


def number(value):
    return f"{value / 1e6:g}M" if value >= 1e6 else f"{value / 1e3:g}k" if value >= 1e3 else f"{value:g}"


def ticks(low, high):
    """1, 2, 5 times powers of ten."""
    steps = [m * 10**e for e in range(-2, 9) for m in (1, 2, 5)]
    return [s for s in steps if low * 0.999 <= s <= high * 1.001]


def panel(quantity, curves, left):
    points = [p for c in curves for p in c["points"] if p[0] > 0]
    x0, x1 = (f(p[0] for p in points) for f in (min, max))
    y0, y1 = min(p[1] for p in points) / 1.3, max(p[1] for p in points) * 1.5 ** (1 + len(curves))  # room for the names
    place_x = lambda x: left + MARGIN + (WIDTH - MARGIN - 15) * math.log(x / x0) / math.log(x1 / x0)
    place_y = lambda y: 30 + (HEIGHT - 75) * (1 - math.log(y / y0) / math.log(y1 / y0))
    out = [f'<text x="{left + MARGIN}" y="18" font-weight="bold">ms by {quantity}</text>']
    for tick in ticks(y0, y1):
        y = place_y(tick)
        out.append(f'<path d="M{place_x(x0):.1f} {y:.1f}H{place_x(x1):.1f}" stroke="#ddd"/>')
        out.append(f'<text x="{left + MARGIN - 6}" y="{y + 4:.1f}" text-anchor="end">{number(tick)}</text>')
    for tick in ticks(x0, x1)[:: 2 if x1 / x0 > 100 else 1]:
        out.append(f'<text x="{place_x(tick):.1f}" y="{HEIGHT - 28}" text-anchor="middle">{number(tick)}</text>')
    for row, curve in enumerate(curves):
        colour, at = COLOURS[curve["frame"]], [(place_x(x), place_y(y)) for x, y in curve["points"] if x > 0]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in at)
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in at]
        label = f'{curve["frame"]}: exponent {exponent(curve["points"]):.2f}'
        out.append(f'<text x="{left + MARGIN + 6}" y="{44 + 15 * row}" fill="{colour}">{label}</text>')
    return out


def main():
    with open(sys.argv[1]) as file:
        curves = json.load(file)["curves"]
    quantities = list(dict.fromkeys(c["quantity"] for c in curves))
    for curve in curves:
        row = ", ".join(f"{number(x)}: {y:.0f}" for x, y in curve["points"])
        print(f'{curve["quantity"]:10} {curve["frame"]:20} exponent {exponent(curve["points"]):.2f}   ms at {row}')
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH * len(quantities)} {HEIGHT}" '
        'font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>'
    ]
    for place, quantity in enumerate(quantities):
        out += panel(quantity, [c for c in curves if c["quantity"] == quantity], WIDTH * place)
    with open(sys.argv[2], "w") as file:
        file.write("\n".join(out + ["</svg>", ""]))


if __name__ == "__main__":
    main()
