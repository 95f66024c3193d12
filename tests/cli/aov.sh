#!/usr/bin/env bash
# Output variables as files, read back by a reader of its own (tests/support/read_exr.py).
support=$(cd "$(dirname "$0")/../support" && pwd)
source "$(dirname "$0")/lib.bash"
small=(-r 96x54 -s 8)

succeeds render builtin:cubes -o plain.exr "${small[@]}"
succeeds render builtin:cubes -o a.exr "${small[@]}" --fstop 2 \
    --aov depth,normal,position,uv,motion,coc,time,object-id,material-id,cryptomatte,coverage,variance
succeeds render builtin:cubes -o b.exr "${small[@]}" --fstop 2 -t 1 \
    --aov depth,normal,position,uv,motion,coc,time,object-id,material-id,cryptomatte,coverage,variance
check "threads do not change a byte" cmp -s a.exr b.exr
check "an independent reader finds masks that add up, ids of the manifest, and rules" python3 - "$support" <<'PY'
import json, struct, sys
sys.path.insert(0, sys.argv[1])
import read_exr

parts = {p["attributes"]["name"].decode(): p for p in read_exr.read("a.exr")}
assert set(parts) == set("rgba depth normal position uv motion coc time object-id material-id cryptomatte coverage variance".split())
assert all("rule" in p["attributes"] for name, p in parts.items() if name != "rgba")
coverage = parts["coverage"]["channels"]["coverage"]
crypto, header = parts["cryptomatte"]["channels"], parts["rgba"]["attributes"]
(key,) = [k[:-5] for k in header if k.startswith("cryptomatte/") and k.endswith("/name") and header[k] == b"CryptoObject"]
assert header[key + "/hash"] == b"MurmurHash3_32" and header[key + "/conversion"] == b"uint32_to_float32"
manifest = json.loads(header[key + "/manifest"])
known = {struct.unpack("<f", struct.pack("<I", int(h, 16)))[0]: name for name, h in manifest.items()}
objects = json.loads(header["objects"])
ids = parts["object-id"]["channels"]["id.object"]
ranks = [("CryptoObject%02d.%s" % (l, a), "CryptoObject%02d.%s" % (l, b)) for l in range(3) for a, b in ("rg", "ba")]
seen = set()
for i, c in enumerate(coverage):
    shares = [(crypto[a][i], crypto[b][i]) for a, b in ranks]
    assert sum(s for _, s in shares) <= c + 1e-6
    if shares[-1][1] == 0:
        assert abs(sum(s for _, s in shares) - c) < 1e-6
    assert all(known[x] for x, s in shares if s > 0)
    assert all(s >= t for (_, s), (_, t) in zip(shares, shares[1:]))
    if ids[i]:
        assert known[shares[0][0]] == objects[ids[i] - 1] or shares[0][1] == shares[1][1]
        seen.add(ids[i])
assert len(seen) > 2, seen
assert any(x < 0 for x in parts["coc"]["channels"]["coc"]) or any(x > 0 for x in parts["coc"]["channels"]["coc"])
PY
refuses 2 '--aov' render builtin:cubes -o a.png "${small[@]}" --aov coc
refuses 2 'beauty' render builtin:cubes -o a.exr "${small[@]}" --aov beauty
refuses 2 'twice' render builtin:cubes -o a.exr "${small[@]}" --aov coc,coc
finish
