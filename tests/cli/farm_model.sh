#!/usr/bin/env bash
# bench/farm_model.py against what can be worked out by hand, and with what `render --stats` writes.
model=$(cd "$(dirname "$0")/../../bench" && pwd)/farm_model.py
source "$(dirname "$0")/lib.bash"

check "its limits are those by hand" python3 - "$model" <<'PY'
import importlib.util, json, math, sys
spec = importlib.util.spec_from_file_location("farm_model", sys.argv[1])
model = importlib.util.module_from_spec(spec)
spec.loader.exec_module(model)


def write(name, totals, spp=16, load=0.0, setup=0.0):
    json.dump([{"frame": i, "spp": spp, "width": 640, "height": 512,
                "times_ms": {"total": 1000 * t, "load": 1000 * load, "pose": 1000 * setup, "samples": 0, "bin": 0, "prepare_shading": 0}}
               for i, t in enumerate(totals)], open(name, "w"))


PERFECT = "--start 0 --straggle 0 --slow 0 --mtbf 0 --disk 1e12 --disk-ops 1e12 --latency 0 --join 1e12"


def times(files, ranks, more="", perfect=PERFECT):
    options = model.parse(f"a={files} --ranks {ranks} {perfect} {more}".split())
    return model.simulate(model.Job("a", files.split(",")), ranks, options)


def near(a, b, share=1e-6):
    assert abs(a - b) <= share * b, (a, b)


# Nothing in the way: the sum of the frames over the machines, and never less than a frame.
write("even", [2.0])
for ranks in (1, 10, 100):
    for split in ("frames", "mpi", "queue"):
        near(times("even", ranks, "--frames 100")[split], 200.0 / ranks)
    near(times("even", 2 * ranks, "--frames 100")["tiles"], 200.0 * math.ceil(160 / ranks) / 320)  # of 320 tiles
for split in ("frames", "mpi", "queue"):
    near(times("even", 1000, "--frames 100")[split], 2.0)
    near(times("even", 30, "--frames 100")[split], 8.0)  # 4 frames for some
write("uneven", [1.0, 2.0, 6.0])
assert all(abs(t - 9.0) < 1e-6 for t in times("uneven", 1, "--frames 3").values())
near(times("uneven", 1, "--frames 300")["frames"], 900.0)
near(times("uneven", 3, "--frames 3")["frames"], 6.0)

# Starting up and reading the scene, once.
write("loads", [2.0], load=1.0)
near(times("loads", 10, "--frames 100 --start 5")["frames"], 5 + 1 + 20)

# Parts of a frame repeat its setup; a part has whole tiles (640 x 512: 320 of them) and whole samples (16).
write("setup", [2.0], setup=0.5)
near(times("setup", 10, "--frames 100")["tiles"], 100 * (0.5 + 1.5 / 10))
near(times("setup", 200, "--frames 100")["tiles"], 100 * (0.5 + 1.5 * 2 / 320))
write("fewer", [0.8], spp=4)  # on the line 0.4 + 0.1 a sample
near(times("even,fewer", 4, "--frames 100")["samples"], 100 * 0.8)
near(times("even,fewer", 1000, "--frames 100")["samples"], 100 * 0.5)
near(times("setup", 2, "--frames 100 --join 16.05632")["tiles"], 100 * (0.5 + 0.75 + 1.0))  # 49 bytes a pixel

# The fastest of what was measured twice.
write("slower", [3.0])
near(times("slower,even", 1, "--frames 100")["frames"], 200.0)

# Slow machines, and one slow one among many, which the queue gives less to.
near(times("even", 10, "--frames 100 --slow 1 --slow-factor 3")["frames"], 60.0)
some = times("even", 100, "--frames 10000 --slow 0.05 --slow-factor 3")
near(some["frames"], 600.0)
near(some["queue"], 200.0 * 100 / (95 + 5 / 3), 0.05)

# A frame of T at a rate of failures r, with R until it begins again: (exp(r T) - 1) (1 / r + R) on average.
near(times("even", 1, f"--frames 20000 --mtbf {10 / 3600} --requeue 3")["frames"], 20000 * (math.exp(0.2) - 1) * 13, 0.02)
# One failure of 100 machines in 50 s ends all of them: half a frame of 2 s and 3 s each, 0.08 of the time.
near(times("even", 100, f"--frames 200000 --mtbf {5000 / 3600} --requeue 3 --runs 9")["mpi"], 4000 * (1 + 4 / 50), 0.02)

# 1000 machines read 3 MB and ask 5 times, 4 s of the file server; then each writes 18 files of 5 steps: 18 s.
server = "--start 0 --straggle 0 --slow 0 --mtbf 0 --latency 0 --disk 1000 --disk-ops 5000 --files 18 --file-mb 0"
near(times("even", 1000, "--frames 1000", server)["frames"], 22.0)
# The same machines for every split: dealing and queueing differ in nothing where each has one frame.
all_kinds = times("even", 1000, "--frames 1000", "")
near(all_kinds["queue"], all_kinds["frames"], 0.5)
PY
for s in 4 1; do succeeds render builtin:cubes -o 'f.#.exr' -f 1-3 -r 96x54 -s $s --stats $s.json; done
check "it reads statistics" python3 "$model" cubes=4.json,1.json --ranks 1,7 >table
check "and prints a table" grep -qE '^\| 7 \|( [0-9.]+ (s|min|h) \([0-9]+%\) \|){5}$' table
check "other files are one line" bash -c '! python3 "$1" a=table 2>err && test "$(wc -l <err)" = 1' - "$model"
finish
