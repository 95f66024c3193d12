#!/usr/bin/env python3
"""How long a sequence takes on N machines: a model fed by measured frames (docs/use/farm.md).

    pentaprism render scene.glb -o 'f.####.exr' -f 1-240x10 --stats measured.json
    python3 bench/farm_model.py measured.json --frames 10000

Each machine starts up, reads the scene, and takes its share. Machines differ in speed (lognormal), fail by chance (exponential) and
then start again, losing the frame under way, as --resume does. Files go to one file system whose bandwidth all share. Splits:
frames (every N-th, as --shard and mpirun do), queue (whoever is free takes the next: what dealing in turn loses to it) and
tiles (each frame by all machines: posing, binning and shadow maps in every one of them, the rest divided, one of them joins).
"""
import argparse
import heapq
import json
import math
import random

SETUP = ("pose", "samples", "bin", "prepare_shading")  # what a part of a frame repeats
SHARD_BYTES = 49  # for each pixel of a part


class Frame:
    def __init__(self, stats):
        times = stats["times_ms"]
        self.total = (times["total"] + times.get("write", 0.0)) / 1000.0
        self.setup = sum(times[stage] for stage in SETUP) / 1000.0
        self.pixels = stats["width"] * stats["height"]


def machine(rng, options):
    """Seconds that this machine takes for one second of the measured one."""
    return math.exp(rng.gauss(0.0, options.straggle))


def work(seconds, rng, options):
    """Seconds that it takes to get `seconds` of one frame done, with failures and starting again."""
    spent = 0.0
    while options.mtbf > 0.0:
        failure = rng.expovariate(1.0 / (3600.0 * options.mtbf))
        if failure >= seconds:
            break
        spent += failure + options.start + options.load
    return spent + seconds


def by_frames(costs, ranks, rng, options):
    ends = []
    for rank in range(ranks):
        speed = machine(rng, options)
        mine = costs[rank::ranks]
        ends.append((options.start + options.load + sum(work(c * speed, rng, options) for c in mine)) if mine else 0.0)
    return max(ends)


def by_queue(costs, ranks, rng, options):
    free = [(options.start + options.load, machine(rng, options)) for _ in range(ranks)]
    heapq.heapify(free)
    for cost in costs:
        now, speed = heapq.heappop(free)
        heapq.heappush(free, (now + work(cost * speed, rng, options), speed))
    return max(now for now, _ in free)


def by_tiles(frames, ranks, rng, options):
    speeds = [machine(rng, options) for _ in range(ranks)]
    slowest = max(speeds)
    end = options.start + options.load
    for frame in frames:
        part = work((frame.setup + (frame.total - frame.setup) / ranks) * slowest, rng, options)
        joined = frame.pixels * SHARD_BYTES * (ranks - 1) / ranks / (options.network * 1e6)
        end += part + joined
    return end


def simulate(frames, ranks, options):
    """Median hours of each split over a few runs; none is faster than the file system takes the files."""
    disk = len(frames) * options.file_mb / options.disk
    runs = {"frames": [], "queue": [], "tiles": []}
    for run in range(options.runs):
        rng = random.Random(1000 * run + ranks)
        costs = [frame.total for frame in frames]
        runs["frames"].append(by_frames(costs, ranks, rng, options))
        runs["queue"].append(by_queue(costs, ranks, rng, options))
        runs["tiles"].append(by_tiles(frames, ranks, rng, options))
    return {split: max(disk, sorted(times)[len(times) // 2]) / 3600.0 for split, times in runs.items()}


def parse(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("measured", help="what render --stats wrote for some frames of the sequence")
    parser.add_argument("--frames", type=int, default=10000, help="in the sequence; the measured ones are spread over it")
    parser.add_argument("--ranks", default="1,10,100,1000", help="numbers of machines, with commas")
    parser.add_argument("--start", type=float, default=5.0, help="seconds until a process runs")
    parser.add_argument("--load", type=float, default=None, help="seconds to read the scene (default: as measured)")
    parser.add_argument("--straggle", type=float, default=0.1, help="sigma of the logarithm of the machines' speeds")
    parser.add_argument("--mtbf", type=float, default=1000.0, help="hours between failures of a machine; 0: none")
    parser.add_argument("--disk", type=float, default=1000.0, help="MB a second of the shared file system")
    parser.add_argument("--network", type=float, default=1000.0, help="MB a second into the process that joins")
    parser.add_argument("--file-mb", type=float, default=10.0, help="of a frame's files")
    parser.add_argument("--runs", type=int, default=5)
    return parser.parse_args(arguments)


def main():
    options = parse()
    with open(options.measured) as file:
        stats = json.load(file)
    stats = stats if isinstance(stats, list) else [stats]
    measured = [Frame(s) for s in stats]
    if options.load is None:
        options.load = stats[0]["times_ms"]["load"] / 1000.0
    frames = [measured[i * len(measured) // options.frames] for i in range(options.frames)]
    total = sum(frame.total for frame in frames) / 3600.0
    print(f"{options.frames} frames, {total:.2f} hours on one machine as measured")
    print(f"{'machines':>8} {'split':>7} {'hours':>9} {'efficiency':>11}")
    for ranks in (int(text) for text in options.ranks.split(",")):
        for split, hours in simulate(frames, ranks, options).items():
            print(f"{ranks:8} {split:>7} {hours:9.3f} {total / ranks / hours:10.0%}")


if __name__ == "__main__":
    main()
