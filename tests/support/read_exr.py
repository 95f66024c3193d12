"""Reads scan-line OpenEXR files, single or multi-part, ZIP, without OpenEXR: an independent reader for tests.

After the file layout document of OpenEXR ("The OpenEXR File Layout"). read(path) gives a list of parts, each
{"attributes": {name: bytes}, "channels": {name: [values, row by row]}, "width": n, "height": n}.
"""
import array
import struct
import sys
import zlib


def _string(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode("utf-8", "surrogateescape"), end + 1


def _header(data, at):
    attributes = {}
    while data[at] != 0:
        name, at = _string(data, at)
        _, at = _string(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(blob):
    """Names and types (0 UINT, 1 HALF, 2 FLOAT), in file order."""
    channels, at = [], 0
    while blob[at] != 0:
        name, at = _string(blob, at)
        channels.append((name, struct.unpack_from("<i", blob, at)[0]))
        at += 16
    return channels


def _unzip(packed, size):
    if len(packed) == size:  # stored as it is
        return packed
    raw = bytearray(zlib.decompress(packed))
    for i in range(1, len(raw)):  # differences to values
        raw[i] = (raw[i - 1] + raw[i] - 128) & 255
    half = (len(raw) + 1) // 2
    out = bytearray(len(raw))
    out[0::2], out[1::2] = raw[:half], raw[half:]
    return bytes(out)


def read(path):
    data = open(path, "rb").read()
    magic, version = struct.unpack_from("<II", data, 0)
    assert magic == 20000630, "not an OpenEXR file"
    multi, at, headers = bool(version & 0x1000), 8, []
    while True:
        if multi and data[at] == 0:
            at += 1
            break
        attributes, at = _header(data, at)
        headers.append(attributes)
        if not multi:
            break
    parts, counts = [], []
    for attributes in headers:
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        assert attributes["compression"][0] == 3, "only ZIP, 16 rows a block, is read"
        width, height = x1 - x0 + 1, y1 - y0 + 1
        kinds = _channels(attributes["channels"])
        values = {name: array.array("fI"[kind == 0] if kind != 1 else "f", bytes(4 * width * height)) for name, kind in kinds}
        parts.append({"attributes": attributes, "channels": values, "width": width, "height": height,
                      "kinds": kinds, "y0": y0})
        counts.append((height + 15) // 16)
    offsets = struct.unpack_from("<%dQ" % sum(counts), data, at)
    part_of_chunk = [p for p, n in enumerate(counts) for _ in range(n)]
    for chunk, offset in enumerate(offsets):
        part = parts[part_of_chunk[chunk]]
        if multi:
            assert struct.unpack_from("<i", data, offset)[0] == part_of_chunk[chunk]
            offset += 4
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(16, part["y0"] + part["height"] - y)
        row_bytes = sum(part["width"] * (2 if kind == 1 else 4) for _, kind in part["kinds"])
        block, at = _unzip(data[offset + 8:offset + 8 + size], rows * row_bytes), 0
        for row in range(y - part["y0"], y - part["y0"] + rows):
            for name, kind in part["kinds"]:
                n = part["width"]
                values = struct.unpack_from("<%d%s" % (n, "Ief"[kind]), block, at)
                at += n * (2 if kind == 1 else 4)
                part["channels"][name][row * n:(row + 1) * n] = array.array("fI"[kind == 0], values)
    return parts


if __name__ == "__main__":
    for p in read(sys.argv[1]):
        print(p["attributes"].get("name", b"")[4:].decode(errors="replace"), p["width"], p["height"],
              " ".join(p["channels"]))
