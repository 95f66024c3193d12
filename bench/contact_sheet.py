#!/usr/bin/env python3
"""A contact sheet of a data set: some frames from left to right, what there is of each from top to bottom.

    pentaprism render race.glb --dataset race -f 1-24 -r 640x360 --fstop 2 --shutter 0.8
    python3 bench/contact_sheet.py race -o race.jpg

Wants NumPy and Pillow (packaging/apt-bench.txt). Depth is shown by its logarithm, flow by hue and length, the circle of
confusion red in front of the focus plane and blue behind it.
"""
import argparse
import json
import pathlib
import sys

import numpy
from PIL import Image


def grey(values):
    return numpy.repeat((255 * numpy.clip(values, 0, 1)).astype(numpy.uint8)[:, :, None], 3, axis=2)


def depth_picture(folder, frame):
    z = numpy.load(folder / "depth" / f"{frame}.npy")
    seen = numpy.isfinite(z)
    logs = numpy.log(numpy.where(seen, z, 1.0))
    low, high = (numpy.percentile(logs[seen], (1, 99)) if seen.any() else (0.0, 1.0))
    return grey(numpy.where(seen, 0.95 - 0.85 * (logs - low) / max(high - low, 1e-9), 0.0))


def flow_picture(path):
    data = path.read_bytes()
    mark, width, height = (numpy.frombuffer(data, "<f4", 1)[0], *numpy.frombuffer(data, "<i4", 2, 4))
    if mark != numpy.float32(202021.25):
        raise ValueError(f"{path}: it is no .flo")
    uv = numpy.frombuffer(data, "<f4", 2 * width * height, 12).reshape(height, width, 2)
    length, angle = numpy.hypot(uv[..., 0], uv[..., 1]), numpy.arctan2(uv[..., 1], uv[..., 0])
    most = max(numpy.percentile(length, 99), 1e-6)
    hsv = numpy.stack([(angle / (2 * numpy.pi) % 1.0) * 255, numpy.clip(length / most, 0, 1) * 255,
                       numpy.full_like(length, 255)], axis=2).astype(numpy.uint8)
    return numpy.asarray(Image.fromarray(hsv, "HSV").convert("RGB"))


def coc_picture(folder, frame):
    coc = numpy.load(folder / "coc" / f"{frame}.npy")
    scaled = coc / max(numpy.percentile(numpy.abs(coc), 99), 1e-6)
    front, back = numpy.clip(-scaled, 0, 1), numpy.clip(scaled, 0, 1)
    return (255 * (1 - numpy.stack([back, front + back, front], axis=2).clip(0, 1))).astype(numpy.uint8)


def rows_of(folder, frame):
    for kind in ("blur", "sharp-open", "sharp", "sharp-close"):
        yield numpy.asarray(Image.open(folder / kind / f"{frame}.png").convert("RGB"))
    yield depth_picture(folder, frame)
    yield flow_picture(folder / "flow" / f"{frame}.flo")
    yield flow_picture(folder / "flow-shutter" / f"{frame}.flo")
    yield coc_picture(folder, frame)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="what render --dataset made")
    parser.add_argument("-o", "--output", required=True, help=".jpg or .png")
    parser.add_argument("--columns", type=int, default=6, help="frames that are shown, spread over all (default 6)")
    parser.add_argument("--width", type=int, default=160, help="pixels of one picture (default 160)")
    options = parser.parse_args()
    try:
        frames = [f"{int(f['frame']):04}" for f in json.loads((options.folder / "camera.json").read_text())["frames"]]
        chosen = [frames[i * len(frames) // options.columns] for i in range(min(options.columns, len(frames)))]
        columns = [list(rows_of(options.folder, frame)) for frame in chosen]
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"contact_sheet.py: error: {options.folder} is no whole data set: {error}")
    height, width = columns[0][0].shape[:2]
    size = (options.width, max(1, round(options.width * height / width)))
    sheet = Image.new("RGB", (len(columns) * size[0], len(columns[0]) * size[1]))
    for x, column in enumerate(columns):
        for y, picture in enumerate(column):
            sheet.paste(Image.fromarray(picture).resize(size, Image.LANCZOS), (x * size[0], y * size[1]))
    sheet.save(options.output, quality=88)


if __name__ == "__main__":
    main()
