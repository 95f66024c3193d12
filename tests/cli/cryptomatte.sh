#!/usr/bin/env bash
# Cryptomatte as another program reads it: files by OpenImageIO, ids by MurmurHash3 and masks by the specification's words,
# written here once more; against majority ids, and against many more samples.
source "$(dirname "$0")/lib.bash"
python=
for candidate in python3 /usr/bin/python3; do
    "$candidate" -c 'import numpy, OpenImageIO' 2>/dev/null && python=$candidate && break
done
[[ -n $python ]] || { echo "skipped: no OpenImageIO for Python (packaging/apt-readers.txt)"; exit 77; }

# PENTAPRISM_SCENES adds a scene of others, with names of others.
scenes=(builtin:cubes builtin:fairy-forest)
[[ ! -e ${PENTAPRISM_SCENES:-}/race/race.glb ]] || scenes+=("$PENTAPRISM_SCENES/race/race.glb")
for scene in "${scenes[@]}"; do
    wanted=(-r 160x90 --fstop 2 --shutter 1 --frame 12 --aov cryptomatte,object-id,material-id,coverage)
    succeeds render "$scene" -o few.exr "${wanted[@]}" -s 16
    succeeds render "$scene" -o many.exr "${wanted[@]}" -s 256 --seed 1
    check "$scene: another reader's masks are ours" "$python" - <<'PY'
import json, math, sys
import numpy as np
import OpenImageIO as oiio


def parts(path):
    """Part name: ({channel: array}, {attribute: value})."""
    file, found = oiio.ImageInput.open(path), {}
    while file.seek_subimage(len(found), 0):
        spec = file.spec()
        kind = oiio.UINT if spec.format == oiio.UINT else oiio.FLOAT
        values = file.read_image(len(found), 0, 0, spec.nchannels, kind)
        assert values.shape == (90, 160, spec.nchannels), values.shape
        found[spec.get_string_attribute("oiio:subimagename")] = (
            {name: values[:, :, i] for i, name in enumerate(spec.channelnames)},
            {a.name: a.value for a in spec.extra_attribs})
    return found


def murmur3(data):  # Appleby's MurmurHash3_x86_32, seed 0
    def rotate(x, r):
        return (x << r | x >> (32 - r)) & 0xffffffff
    h = 0
    for i in range(0, len(data) - len(data) % 4, 4):
        k = int.from_bytes(data[i:i + 4], "little") * 0xcc9e2d51 & 0xffffffff
        h = (rotate(h ^ (rotate(k, 15) * 0x1b873593 & 0xffffffff), 13) * 5 + 0xe6546b64) & 0xffffffff
    k = int.from_bytes(data[len(data) - len(data) % 4:], "little") * 0xcc9e2d51 & 0xffffffff
    h ^= (rotate(k, 15) * 0x1b873593 & 0xffffffff) ^ len(data)
    for shift, factor in ((16, 0x85ebca6b), (13, 0xc2b2ae35), (16, 1)):
        h = (h ^ h >> shift) * factor & 0xffffffff
    return h


def id_of(name):  # no exponent of all zeros or all ones: neither denormals nor NaNs
    h = murmur3(name.encode())
    return h ^ 1 << 23 if h >> 23 & 255 in (0, 255) else h


def masks(file, layer):
    """{name: mask}, by manifest and ranks."""
    about = file["rgba"][1]
    key = "cryptomatte/%07x" % (murmur3(layer.encode()) >> 4)
    assert about[key + "/name"] == layer
    assert about[key + "/hash"] == "MurmurHash3_32" and about[key + "/conversion"] == "uint32_to_float32"
    manifest = {name: int(text, 16) for name, text in json.loads(about[key + "/manifest"]).items()}
    assert all(value == id_of(name) for name, value in manifest.items())
    assert len(set(manifest.values())) == len(manifest), "two names of one id"
    channels = file["cryptomatte"][0]
    ranks = [(channels[f"{layer}{level:02}.{i}"].copy().view(np.uint32), channels[f"{layer}{level:02}.{c}"])
             for level in range(3) for i, c in ("rg", "ba")]
    known = np.array([0] + list(manifest.values()), np.uint32)
    assert all(np.isin(ids[shares > 0], known[1:]).all() and (ids[shares == 0] == 0).all() for ids, shares in ranks)
    full = ranks[-1][1] == 0  # the six ranks hold all that the pixel sees
    return {name: sum(np.where(ids == value, shares, 0) for ids, shares in ranks) for name, value in manifest.items()}, full


few, many = parts("few.exr"), parts("many.exr")
for kind, layer in (("object", "CryptoObject"), ("material", "CryptoMaterial")):
    names = json.loads(few["rgba"][1][kind + "s"])
    one, full = masks(few, layer)
    two, full_of_many = masks(many, layer)
    assert set(one) == set(two) == set(names) and len(names) > 2
    for file, (of, whole) in ((few, (one, full)), (many, (two, full_of_many))):
        coverage, ids = file["coverage"][0]["coverage"], file[kind + "-id"][0]["id." + kind]
        stack = np.stack([1 - coverage] + [of[name] for name in names])  # 0 is the background, as in the ids
        assert stack.min() > -1e-6 and (stack.sum(0) < 1 + 1e-5).all()
        assert np.abs(stack.sum(0) - 1)[whole].max() < 1e-5 and whole.mean() > 0.9
        # The majority's mask is the largest one, ties aside.
        assert (np.take_along_axis(stack, ids[None].astype(int), 0)[0] >= stack.max(0) - 1e-6).all()
    sure, off, expected = np.zeros((90, 160), bool), 0.0, 0.0
    for name in names:
        a, b = one[name], two[name]
        sure |= b > 0.9
        spread = b * (1 - b) * (1 / 16 + 1 / 256) + 1e-6  # of independent samples; ours lie better
        assert abs((a - b).sum()) < 5 * math.sqrt(spread.sum()), (name, (a - b).sum())
        off, expected = off + ((a - b) ** 2).sum(), expected + spread.sum()
    assert off < expected, (off, expected)
    seen_few, seen_many = few[kind + "-id"][0]["id." + kind], many[kind + "-id"][0]["id." + kind]
    assert sure.mean() > 0.3 and (seen_few != seen_many)[sure].mean() < 1e-3
    soft = np.mean(sum((0.02 < m) & (m < 0.98) for m in two.values()) > 0)
    assert soft > 0.02, "nothing is blurred"
    print(f"{layer}: {off / expected:.2f} of the variance of independent samples; {len(names)} names, {sum(m.max() > 0 for m in two.values())} seen, {soft:.0%} of the pixels of several; "
          f"{sure.mean():.0%} are surely of one, in {(seen_few != seen_many)[sure].sum()} of them 16 samples say another")
PY
done
finish
