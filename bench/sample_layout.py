#!/usr/bin/env python3
"""What the layout of the samples does to pictures: error by scale, spectra and error x time, against free sampling.

    python3 bench/sample_layout.py build/ci/bench/sample_layout --folder /tmp/layout -o docs/images/sample-layout

The program renders (24 seeds of four samplers, a reference of 4096 samples per pixel; a folder with an index.json is taken as it is); tables
go to stdout as Markdown, figures to OUTPUT-spectra.svg and OUTPUT-errors.png. Fails with exit code 1 if block means of the default sampler
vary more than they may.

Free sampling is `sobol`: Owen-scrambled Sobol' points, each pixel by itself (docs/develop/algorithms.md 9.1). Also shown: what the default's
own pixels would give if they had nothing to do with each other.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np

DEFAULT, FREE = "stratified", "sobol"
SAMPLERS = ["stratified", "sobol", "blue-noise", "independent"]
COLOURS = {"stratified": "#0072b2", "sobol": "#d55e00", "blue-noise": "#009e73", "independent": "#777777"}
SCALES = [1, 4, 8]
# Most that the variance of block means may be, times that of free sampling.
BOUNDS = {"both": 1.1, "both-x2": 1.1, "motion": 0.75}
DEVIATIONS = 3.0  # standard errors by which a bound must be missed to count


def load(folder):
    """{(frame, step): {sampler: (ms, pictures[seed, y, x])}}"""
    frames = {}
    for entry in json.loads((folder / "index.json").read_text()):
        shape = (entry["seeds"], entry["height"], entry["width"])
        pictures = np.fromfile(folder / entry["file"], np.float32).reshape(shape).astype(float)
        frames.setdefault((entry["frame"], entry["step"]), {})[entry["sampler"]] = (entry["ms"], pictures)
    return frames


def blocks(pictures, side):
    n, h, w = pictures.shape
    return pictures.reshape(n, h // side, side, w // side, side).mean((2, 4))


def variance(pictures, side):
    """Mean over the picture of the variance over seeds of block means."""
    return blocks(pictures, side).var(0, ddof=1).mean()


def ratio(of, over):
    """of(pictures) / over(pictures) and its standard error: each seed left out in turn, pairs of (quantity, pictures)."""
    (f, a), (g, b) = of, over
    whole = f(a) / g(b)
    n = len(a)
    left = np.array([f(np.delete(a, i, 0)) / g(np.delete(b, i, 0)) for i in range(n)])
    return whole, np.sqrt((n - 1) / n * ((left - left.mean()) ** 2).sum())


def power(errors):
    """Mean power spectrum over seeds, white noise of variance 1 being 1; frequencies centred."""
    n, h, w = errors.shape
    window = np.outer(np.hanning(h), np.hanning(w))
    window /= np.sqrt((window**2).mean())
    return np.fft.fftshift((np.abs(np.fft.fft2(errors * window)) ** 2).mean(0) / (h * w))


def radial(spectrum, bins=24):
    h, w = spectrum.shape
    fy, fx = np.meshgrid(np.fft.fftshift(np.fft.fftfreq(h)), np.fft.fftshift(np.fft.fftfreq(w)), indexing="ij")
    f = np.hypot(fx, fy)
    which = np.minimum((f / 0.5 * bins).astype(int), bins)
    centre = (np.arange(bins) + 0.5) / bins * 0.5
    return centre, np.array([spectrum[which == k].mean() for k in range(bins)])


def lines(spectrum):
    """Power where a pattern of blocks of 4x4 pixels would have its lines, over that of the places around each, the largest."""
    h, w = spectrum.shape
    largest = 0.0
    for ky in (-h // 4, 0, h // 4):
        for kx in (-w // 4, 0, w // 4):
            if kx == ky == 0:
                continue
            y, x = h // 2 + ky, w // 2 + kx
            near = spectrum[max(0, y - 6) : y + 7, max(0, x - 6) : x + 7].copy()
            peak = spectrum[y - 1 : y + 2, x - 1 : x + 2].mean()
            near = near[np.ix_([0, 1, 2, 3, -4, -3, -2, -1], [0, 1, 2, 3, -4, -3, -2, -1])]
            largest = max(largest, peak / near.mean())
    return largest


def lanes(pictures):
    """Least and greatest variance over the places within a block of 4x4 pixels, over their mean."""
    v = pictures.var(0, ddof=1)
    of_lane = v.reshape(v.shape[0] // 4, 4, v.shape[1] // 4, 4).mean((0, 2))
    return of_lane.min() / of_lane.mean(), of_lane.max() / of_lane.mean()


def correlation(a, b):
    return (a * b).mean() / np.sqrt((a**2).mean() * (b**2).mean())


def tables(frames):
    failed = []
    print("| frame | sampler | ms | error, pixel | 4x4 | 8x8 | time to the same pixel error | 4x4 | 8x8 |")
    print("|---|---|---:|---:|---:|---:|---:|---:|---:|")
    for (frame, step), of in frames.items():
        if step:
            continue
        reference = of["reference"][1]
        mse = {s: [((blocks(of[s][1], k) - blocks(reference, k)) ** 2).mean() for k in SCALES] for s in SAMPLERS}
        for s in SAMPLERS:
            times = " | ".join(f"{mse[s][k] * of[s][0] / (mse[DEFAULT][k] * of[DEFAULT][0]):.2f}" for k in range(3))
            errors = " | ".join(f"{np.sqrt(e):.4f}" for e in mse[s])
            print(f"| {frame} | `{s}` | {of[s][0]:.1f} | {errors} | {times} |")
    print("\n| frame | variance of 4x4 means over free | 8x8 | over unrelated pixels of its own, 4x4 | 8x8 | bound |")
    print("|---|---:|---:|---:|---:|---:|")
    for (frame, step), of in frames.items():
        if step:
            continue
        a, b = of[DEFAULT][1], of[FREE][1]
        row = []
        for k in (4, 8):
            value, error = ratio((lambda p, k=k: variance(p, k), a), (lambda p, k=k: variance(p, k), b))
            row.append((value, error))
        for k in (4, 8):
            row.append(ratio((lambda p, k=k: variance(p, k), a), (lambda p, k=k: variance(p, 1) / k**2, a)))
        bound = BOUNDS.get(frame.split("/")[1])
        print(f"| {frame} | " + " | ".join(f"{v:.2f} +- {e:.2f}" for v, e in row) + f" | {bound or ''} |")
        if bound and any(v - DEVIATIONS * e > bound for v, e in row[:2]):
            failed.append(frame)
    print("\n| frame | sampler | lines of 4x4 blocks | variance by place in the block | error shared with the next frame |")
    print("|---|---|---:|---:|---:|")
    for (frame, step), of in frames.items():
        if step:
            continue
        for s in SAMPLERS:
            errors = of[s][1] - of["reference"][1]
            low, high = lanes(of[s][1])
            following = frames.get((frame, 1))
            shared = ""
            if following:
                shared = f'{correlation(errors, following[s][1] - following["reference"][1]):.3f}'
            print(f"| {frame} | `{s}` | {lines(power(errors)):.2f} | {low:.2f} to {high:.2f} | {shared} |")
    return failed


def draw_spectra(frames, path):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams["svg.hashsalt"] = "pentaprism"
    shown = [f for f in ("fairy-forest/both", "fairy-forest/motion", "fairy-forest/defocus") if (f, 0) in frames]
    figure, axes = plt.subplots(2, len(shown), figsize=(3.6 * len(shown), 5.4), sharex=True, squeeze=False)
    for column, frame in enumerate(shown):
        for row, step in enumerate((0, 1)):
            axis = axes[row][column]
            if (frame, step) not in frames:
                continue
            spectra = {}
            for s in SAMPLERS:
                now = frames[frame, 0]
                errors = now[s][1] - now["reference"][1]
                if step:
                    following = frames[frame, 1]
                    errors = following[s][1] - following["reference"][1] - errors
                spectra[s] = radial(power(errors))
            free = spectra[FREE][1].mean()
            for s, (at, values) in spectra.items():
                axis.plot(at, values / free, color=COLOURS[s], label=s, linewidth=1.4)
            axis.set_ylim(0.4, 3.2)
            for f in (0.25, 0.125):
                axis.axvline(f, color="#cccccc", linewidth=0.8, zorder=0)
            axis.set_title(frame if step == 0 else "what changes to the next frame", fontsize=9)
            axis.tick_params(labelsize=8)
    axes[0][0].legend(fontsize=7, loc="center left")
    for axis in axes[1]:
        axis.set_xlabel("cycles per pixel", fontsize=8)
    for row in axes:
        row[0].set_ylabel("power of the error over that of sobol", fontsize=8)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def draw_errors(frames, path):
    """Errors of one seed, grey being none; the row below: means of 4x4 pixels, four times as strong."""
    from PIL import Image

    rows = []
    for frame in ("fairy-forest/both", "fairy-forest/motion"):
        if (frame, 0) not in frames:
            continue
        of = frames[frame, 0]
        for side, gain in ((1, 2.5), (4, 10.0)):
            cells = []
            for s in ("stratified", "sobol", "independent"):
                error = blocks(of[s][1][:1] - of["reference"][1], side)[0]
                grey = np.clip(128 + 255 * gain * error, 0, 255).astype(np.uint8).repeat(side, 0).repeat(side, 1)
                cells.append(np.pad(grey, 4, constant_values=255))
            rows.append(np.hstack(cells))
    Image.fromarray(np.vstack(rows)).save(path, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--folder", type=pathlib.Path, required=True, help="of the pictures, about 150 MB")
    parser.add_argument("--seeds", type=int, default=24)
    parser.add_argument("--reference", type=int, default=4096, help="samples per pixel")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="the beginning of the figures' names")
    arguments = parser.parse_args()
    if not (arguments.folder / "index.json").exists():
        subprocess.run([arguments.program, arguments.folder, str(arguments.seeds), str(arguments.reference)], check=True)
    frames = load(arguments.folder)
    failed = tables(frames)
    if arguments.output:
        draw_spectra(frames, f"{arguments.output}-spectra.svg")
        draw_errors(frames, f"{arguments.output}-errors.png")
    if failed:
        sys.exit(f"block means vary more than they may: {', '.join(failed)}")


if __name__ == "__main__":
    main()
