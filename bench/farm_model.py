#!/usr/bin/env python3
"""How long a sequence takes on N machines: a model fed by measured frames (docs/use/farm.md).

    for run in 1 2 3; do for s in 16 4 1; do
        pentaprism render race.glb -o 'f.####.exr' -f 1-89x8 -s $s --stats race-$s-$run.json
    done; done
    python3 bench/farm_model.py race=race-16-1.json,race-16-2.json,...,race-1-3.json --plot farm.svg

The frames with the most samples are the job; those with fewer tell what a frame costs with a part of its samples. Of a
frame that was measured several times the fastest counts: whatever else the machine did can only have made it slower.
Where it never was idle, measure with -t 1 and count processor time (--cpu).

Each machine starts up, reads the scene and takes its share. Machines differ in speed: a lognormal spread, and a few that
are much slower. They fail by chance (exponential), lose what is under way, as --resume does, and come back. All files
go through one file server, first come, first served. A process goes on when its frame is written.

    frames   every N-th frame, as --shard and a Slurm array deal them
    mpi      the same in one mpirun: a process that fails ends all of them
    queue    whoever is free takes the next frame: what dealing in turn loses to it (not built: it wants a server)
    tiles    each frame by all machines: posing, binning and shadow maps in every one of them, the rest is divided, one joins
    samples  each frame by all machines, each with all pixels and a part of the samples (not built: docs/develop/shards.md)
"""
import argparse
import heapq
import json
import math
import random
import sys

SETUP = ("pose", "samples", "bin", "prepare_shading")  # what a part of a frame repeats
SHARD_BYTES = 49  # for each pixel of a part
SPLITS = ("frames", "mpi", "queue", "tiles", "samples")
HOUR = 3600.0


class Frame:
    """What one frame costs, in seconds of the machine that it was measured on."""

    def __init__(self, stats, cpu):
        times = stats["times_ms"]
        self.total = time_of(stats, cpu) / 1000.0  # the picture is written meanwhile
        self.setup = self.total * sum(times[stage] for stage in SETUP) / times["total"]
        self.pixels = stats["width"] * stats["height"]


def time_of(stats, cpu):
    return stats["cpu_ms"] if cpu else stats["times_ms"]["total"]


class Job:
    """The frames of a sequence, and the line time = fixed + slope * samples per pixel that its measurements lie on."""

    def __init__(self, name, files, cpu=False):
        fastest = {}  # by samples per pixel, then by frame
        for file in files:
            with open(file) as stream:
                stats = json.load(stream)
            for one in stats if isinstance(stats, list) else [stats]:
                frames = fastest.setdefault(one["spp"], {})
                frames[one["frame"]] = min(one, frames.get(one["frame"], one), key=lambda s: time_of(s, cpu))
        self.name, self.spp = name, max(fastest)
        job = fastest[self.spp]
        self.measured = [Frame(job[number], cpu) for number in sorted(job)]
        self.load = min(s["times_ms"]["load"] for s in job.values()) / 1000.0
        means = sorted((spp, mean(Frame(s, cpu).total for s in frames.values())) for spp, frames in fastest.items())
        self.share_of_fixed = fixed_part(means) / means[-1][1] if len(means) > 1 else None
        self.mean = means[-1][1]

    def frames(self, count):
        return [self.measured[i * len(self.measured) // count] for i in range(count)]


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def fixed_part(points):
    """Where the straight line through (samples, seconds) meets no samples: least squares, never below zero."""
    mx, my = mean(x for x, _ in points), mean(y for _, y in points)
    slope = sum((x - mx) * (y - my) for x, y in points) / sum((x - mx) ** 2 for x, _ in points)
    return max(0.0, my - slope * mx)


class FileServer:
    """One queue for all: whoever asks waits until those before are served."""

    def __init__(self, options):
        self.options, self.free = options, 0.0

    def serve(self, now, megabytes, operations):
        begin = max(now, self.free)
        self.free = begin + megabytes / self.options.disk + operations / self.options.disk_ops
        return self.free


def speeds(ranks, rng, options):
    """Seconds that each machine takes for one second of the measured one."""
    return [math.exp(rng.gauss(0.0, options.straggle)) * (options.slow_factor if rng.random() < options.slow else 1.0)
            for _ in range(ranks)]


def time_to_failure(rng, options, machines=1):
    return rng.expovariate(machines / (HOUR * options.mtbf)) if options.mtbf > 0.0 else math.inf


def work(seconds, start_up, rng, options):
    """Until `seconds` of one frame are done without a failure; the machine comes back, and starts up, after each."""
    spent = 0.0
    while (failure := time_to_failure(rng, options)) < seconds:
        spent += failure + options.requeue + start_up
    return spent + seconds


def by_frames(job, frames, ranks, rng, options, next_frame):
    """`next_frame(rank)` is the index of the frame that a free machine takes, or None."""
    server, speed, ready = FileServer(options), speeds(ranks, rng, options), []
    for rank in range(ranks):  # all at once, as the start of a job is
        read = server.serve(options.start, options.scene_mb, 5)
        heapq.heappush(ready, (max(read, options.start + job.load * speed[rank]), rank, False))
    end, start_up = 0.0, options.start + job.load
    while ready:
        now, rank, has_frame = heapq.heappop(ready)
        if has_frame:  # FILE.part, its lock, sync, rename, sync of the folder
            now = server.serve(now, options.file_mb, 5 * options.files) + options.latency
            end = max(end, now)
        if (index := next_frame(rank)) is not None:
            heapq.heappush(ready, (now + work(frames[index].total * speed[rank], start_up, rng, options), rank, True))
    return end


def dealt(ranks, count):
    places = [iter(range(rank, count, ranks)) for rank in range(ranks)]
    return lambda rank: next(places[rank], None)


def one_queue(count):
    places = iter(range(count))
    return lambda rank: next(places, None)


def by_mpi(job, frames, ranks, rng, options):
    """Without single failures, then stretched by those of all: each costs everyone half a frame and a new start."""
    calm = argparse.Namespace(**{**vars(options), "mtbf": 0.0})
    left, end, again = by_frames(job, frames, ranks, rng, calm, dealt(ranks, len(frames))), 0.0, 0
    while (failure := time_to_failure(rng, options, ranks)) < left and again < 100000:
        lost = min(failure, 0.5 * job.mean)
        end += failure + options.requeue + options.start + job.load
        left -= failure - lost
        again += 1
    return end + left


def together(job, frames, ranks, rng, options, seconds):
    """All machines at one frame: the slowest decides, and a failure of any loses it. `seconds(frame)` is its part's."""
    slowest, start_up = max(speeds(ranks, rng, options)), options.start + job.load
    end = max(start_up, options.start + ranks * options.scene_mb / options.disk)
    for frame in frames:
        part = seconds(frame) * slowest
        while (failure := time_to_failure(rng, options, ranks)) < part:
            end += failure + options.requeue + start_up
        joined = frame.pixels * SHARD_BYTES / (options.join * 1e6) if ranks > 1 else 0.0
        end += part + joined + options.file_mb / options.disk + 5 * options.files / options.disk_ops + options.latency
    return end


def by_tiles(job, frames, ranks, rng, options):
    tiles = frames[0].pixels / 1024.0
    busiest = math.ceil(tiles / ranks) * ranks / tiles  # whoever has one tile more than its share
    return together(job, frames, ranks, rng, options,
                    lambda frame: frame.setup + (frame.total - frame.setup) / ranks * busiest)


def by_samples(job, frames, ranks, rng, options):
    fixed, share = job.share_of_fixed, max(1.0 / ranks, 1.0 / job.spp)  # one sample at least
    return together(job, frames, ranks, rng, options, lambda frame: frame.total * (fixed + (1.0 - fixed) * share))


def simulate(job, ranks, options):
    """Median seconds of each split over a few runs."""
    frames = job.frames(options.frames)
    times = {split: [] for split in SPLITS if split != "samples" or job.share_of_fixed is not None}
    for split, ends in times.items():
        for run in range(options.runs):
            rng = random.Random(f"{run} {ranks}")  # the same machines for every split
            if split == "frames":
                end = by_frames(job, frames, ranks, rng, options, dealt(ranks, len(frames)))
            elif split == "queue":
                end = by_frames(job, frames, ranks, rng, options, one_queue(len(frames)))
            else:
                end = {"mpi": by_mpi, "tiles": by_tiles, "samples": by_samples}[split](job, frames, ranks, rng, options)
            ends.append(end)
    return {split: sorted(ends)[len(ends) // 2] for split, ends in times.items()}


def clock(seconds):
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.1f} min" if seconds < 2 * HOUR else f"{seconds / HOUR:.2f} h"


def print_table(job, results, options):
    total = options.frames * job.mean
    fixed = "" if job.share_of_fixed is None else f", of which {job.share_of_fixed:.0%} do not depend on samples"
    print(f"\n{job.name}: {options.frames} frames of {job.mean:.2f} s as measured{fixed}: {clock(total)} on one machine\n")
    splits = list(next(iter(results.values())))
    print("| machines | " + " | ".join(splits) + " |\n|" + "---:|" * (len(splits) + 1))
    for ranks, times in results.items():
        cells = (f"{clock(times[split])} ({total / ranks / times[split]:.0%})" for split in splits)
        print(f"| {ranks} | " + " | ".join(cells) + " |")


def plot(name, jobs, results, options):
    import matplotlib
    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.hashsalt": "farm", "svg.fonttype": "none", "font.size": 9})
    import matplotlib.pyplot as pyplot
    figure, panels = pyplot.subplots(1, len(jobs), figsize=(4.2 * len(jobs), 3.6), sharey=True, squeeze=False)
    style = {"frames": ("C0", "-", "o"), "mpi": ("C1", "--", "s"), "queue": ("C2", ":", "^"), "tiles": ("C3", "-", "v"),
             "samples": ("C4", "-.", "d")}
    for panel, job in zip(panels[0], jobs):
        ranks = list(results[job.name])
        panel.loglog(ranks, [options.frames * job.mean / n / HOUR for n in ranks], color="0.7", lw=3, label="perfect")
        for split in next(iter(results[job.name].values())):
            color, line, mark = style[split]
            panel.loglog(ranks, [results[job.name][n][split] / HOUR for n in ranks], color=color, ls=line, marker=mark,
                         ms=3.5, lw=1.2, label=split)
        panel.set_title(f"{job.name}: {job.mean:.2f} s a frame", fontsize=10)
        panel.set_xlabel("machines")
        panel.grid(True, which="major", color="0.9")
    panels[0][0].set_ylabel(f"hours for {options.frames} frames")
    panels[0][0].legend(fontsize=8, frameon=False)
    figure.tight_layout()
    figure.savefig(name, **({"metadata": {"Date": None}} if name.endswith(".svg") else {}))


def parse(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("jobs", nargs="+", metavar="NAME=FILE[,FILE...]", help="what render --stats wrote for some frames")
    parser.add_argument("--cpu", action="store_true", help="processor time instead of the time that passed: measured with -t 1")
    parser.add_argument("--frames", type=int, default=10000, help="in the sequence; the measured ones are spread over it")
    parser.add_argument("--ranks", default="1,10,100,1000", help="numbers of machines, with commas")
    parser.add_argument("--start", type=float, default=5.0, help="seconds until a process runs")
    parser.add_argument("--straggle", type=float, default=0.1, help="sigma of the logarithm of the machines' speeds")
    parser.add_argument("--slow", type=float, default=0.01, help="share of machines that are much slower")
    parser.add_argument("--slow-factor", type=float, default=3.0, help="by this")
    parser.add_argument("--mtbf", type=float, default=1000.0, help="hours between failures of a machine; 0: none")
    parser.add_argument("--requeue", type=float, default=60.0, help="seconds until a failed machine is given work again")
    parser.add_argument("--disk", type=float, default=1000.0, help="MB a second of the shared file system")
    parser.add_argument("--disk-ops", type=float, default=5000.0, help="its opens, syncs and renames a second")
    parser.add_argument("--latency", type=float, default=0.02, help="seconds that a sync takes when nobody else asks")
    parser.add_argument("--join", type=float, default=200.0, help="MB of parts a second that one process takes and adds")
    parser.add_argument("--scene-mb", type=float, default=3.0, help="that each process reads")
    parser.add_argument("--file-mb", type=float, default=4.0, help="of a frame's files")
    parser.add_argument("--files", type=int, default=1, help="of a frame; a data set has 18")
    parser.add_argument("--runs", type=int, default=5, help="simulations of which the median is taken")
    parser.add_argument("--plot", metavar="FILE.svg", help="a picture of it (needs matplotlib)")
    options = parser.parse_args(arguments)
    for name, least in (("frames", 1), ("runs", 1), ("disk", 1e-9), ("disk_ops", 1e-9), ("join", 1e-9)):
        if getattr(options, name) < least:
            parser.error(f"--{name.replace('_', '-')} is too small")
    try:
        options.ranks = [int(text) for text in options.ranks.split(",")]
    except ValueError:
        parser.error(f"--ranks: '{options.ranks}' is no list such as 1,10,100")
    if min(options.ranks) < 1:
        parser.error("--ranks: a number of machines is 1 or more")
    if not all("=" in job for job in options.jobs):
        parser.error("measured frames are given as NAME=FILE[,FILE...]")
    return options


def main():
    options = parse()
    try:
        jobs = [Job(name, files.split(","), options.cpu) for name, files in (job.split("=", 1) for job in options.jobs)]
    except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
        sys.exit(f"farm_model.py: error: not what render --stats wrote: {error}")
    results = {}
    for job in jobs:
        results[job.name] = {ranks: simulate(job, ranks, options) for ranks in options.ranks}
        print_table(job, results[job.name], options)
    if options.plot:
        plot(options.plot, jobs, results, options)


if __name__ == "__main__":
    main()
