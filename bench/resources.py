#!/usr/bin/env python3
"""What a frame takes in time on one thread and on two, and in memory: renders and reads --stats.

    python3 bench/resources.py build/ci/pentaprism threads     # stages on one and two threads, alternating, least of --repeats
    python3 bench/resources.py build/ci/pentaprism memory      # largest resident memory at 1280x720 by samples per pixel

`threads` needs an idle machine: these are wall times. Both take names of frames to filter by; PENTAPRISM_SCENES adds the real scenes.
`memory` exits with 1 if a frame needs 300 MB or more beside its scene, or one of 1.8 million triangles or more 1.5 GB in all.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

BUILTIN = ["hand", "car", "dragonfly", "fairy-forest", "cubes", "race", "conan", "bridge"]
REAL = {
    "forest": "forest/forest.glb --camera dolly --lens-radius 0.010888 --focus-distance 6",
    "insects": "insects/insects.glb --camera macro --lens-radius 0.004849 --focus-distance 1.2",
    "torcs-race": "torcs/torcs-race.glb --camera chase --lens-radius 0.008872 --focus-distance 15",
    "apartment": "environment/apartment.glb --lens-radius 0.01",
    "hand.glb": "hand/hand.glb",
    "race.glb": "race/race.glb",
}
STAGES = ["pose", "bin", "cover", "visibility", "prepare_shading", "shade", "resolve", "total"]
MOST_BESIDE_SCENE_MB, MOST_OF_LARGE_MB, LARGE = 300, 1500, 1_800_000


def frames(filters):
    found = {name: [f"builtin:{name}"] for name in BUILTIN}
    folder = os.environ.get("PENTAPRISM_SCENES")
    for name, words in REAL.items() if folder else ():
        path, *options = words.split()
        if (pathlib.Path(folder) / path).exists():
            found[name] = [f"{folder}/{path}", *options]
    return {n: w for n, w in found.items() if not filters or any(f in n for f in filters)}


def stats(program, words, folder):
    file = folder / "stats.json"
    command = [program, "render", *words, "-o", folder / "frame.exr", "--overwrite", "-q", "--frame", "24", "--stats", file]
    subprocess.run(command, check=True)
    return json.loads(file.read_text())


def threads(program, filters, repeats, folder):
    print("| frame | triangles | " + " | ".join(f"{s}, ms" for s in STAGES) + " |")
    print("|---|---:|" + "---:|" * len(STAGES))
    for name, words in frames(filters).items():
        least = {}
        for _ in range(repeats):
            for count in (1, 2):
                told = stats(program, [*words, "-r", "1024x768", "-s", "16", "-t", str(count)], folder)
                for stage in STAGES:
                    key = count, stage
                    least[key] = min(least.get(key, float("inf")), told["times_ms"].get(stage, 0.0))
        cells = []
        for stage in STAGES:
            one, two = least[1, stage], least[2, stage]
            cells.append(f"{one:.0f} -> {two:.0f} ({one / two:.2f})" if two > 0 else "")
        print(f"| {name} | {told['triangles']} | " + " | ".join(cells) + " |", flush=True)


def memory(program, filters, counts, folder):
    failed = []
    print("| frame | triangles | scene, MB | samples per pixel | in all, MB | beside the scene, MB | without shadow maps, MB |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name, words in frames(filters).items():
        # The scene alone: one pixel of it.
        scene = stats(program, [*words, "-r", "1280x720", "-s", "1", "--crop", "640,641,360,361", "-t", "1", "--shadows", "off"], folder)
        for spp in counts:
            told = stats(program, [*words, "-r", "1280x720", "-s", str(spp), "-t", "2"], folder)
            unshadowed = stats(program, [*words, "-r", "1280x720", "-s", str(spp), "-t", "2", "--shadows", "off"], folder)
            beside = told["peak_mb"] - scene["peak_mb"]
            without = unshadowed["peak_mb"] - scene["peak_mb"]
            print(f"| {name} | {told['triangles']} | {scene['peak_mb']:.0f} | {spp} | {told['peak_mb']:.0f} | {beside:.0f} | {without:.0f} |", flush=True)
            if beside >= MOST_BESIDE_SCENE_MB:
                failed.append(f"{name} at {spp} samples needs {beside:.0f} MB beside its scene")
            if told["triangles"] >= LARGE and told["peak_mb"] >= MOST_OF_LARGE_MB:
                failed.append(f"{name} at {spp} samples needs {told['peak_mb']:.0f} MB in all")
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("what", choices=["threads", "memory"])
    parser.add_argument("filters", nargs="*", help="parts of frames' names")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--samples", type=int, nargs="+", default=[16, 256], help="of memory; 4096 takes long")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if arguments.what == "threads":
            return threads(arguments.program, arguments.filters, arguments.repeats, pathlib.Path(folder))
        failed = memory(arguments.program, arguments.filters, arguments.samples, pathlib.Path(folder))
    if failed:
        sys.exit("\n".join(failed))


if __name__ == "__main__":
    main()
