#!/usr/bin/env python3
"""Makes a frame of particles small enough to ship.

    scripts/thin_particles.py dd128k_22.bgeo scenes/assets/dd128k_22.bgeo --step 1/2048

Reads the old BGEO (gzipped or plain) that solvers write, and writes the same format with positions alone, each rounded
to a multiple of the step (a power of two, in metres) and in the order of a Morton curve, so that gzip finds what repeats.
Needs nothing but Python.
"""

import argparse
import gzip
import struct
from fractions import Fraction

# Words that a value of each of the format's types takes: float, integer, string index, vector.
FLOAT, INTEGER, INDEXED, VECTOR = 0, 1, 4, 5


def positions(data):
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    if data[:5] != b"BgeoV":
        raise SystemExit("not an old BGEO file")
    _, count, primitives, _, _, attributes, *_ = struct.unpack_from(">9i", data, 5)
    if primitives:
        raise SystemExit("the file holds more than points")
    at, words = 41, 4
    for _ in range(attributes):
        (length,) = struct.unpack_from(">H", data, at)
        at += 2 + length
        size, kind = struct.unpack_from(">Hi", data, at)
        at += 6
        if kind == INDEXED:
            raise SystemExit("attributes of text are not read")
        if kind not in (FLOAT, INTEGER, VECTOR):
            raise SystemExit(f"attributes of type {kind} are not read")
        at += 4 * size
        words += size
    return [struct.unpack_from(">3f", data, at + 4 * words * i) for i in range(count)]


def spread(n):
    """The bits of a number of 21 bits, two zeros after each."""
    for shift, mask in ((32, 0x1F00000000FFFF), (16, 0x1F0000FF0000FF), (8, 0x100F00F00F00F00F), (4, 0x10C30C30C30C30C3), (2, 0x1249249249249249)):
        n = (n | n << shift) & mask
    return n


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("target")
    parser.add_argument("--step", type=Fraction, default=Fraction(1, 2048), help="metres; a power of two keeps its multiples short")
    given = parser.parse_args()
    with open(given.source, "rb") as file:
        rounded = [tuple(round(x / given.step) for x in p) for p in positions(file.read())]
    low = [min(p[k] for p in rounded) for k in range(3)]
    rounded.sort(key=lambda p: sum(spread(p[k] - low[k]) << k for k in range(3)))
    out = bytearray(b"BgeoV" + struct.pack(">9i", 5, len(rounded), 0, 0, 0, 0, 0, 0, 0))
    for p in rounded:
        out += struct.pack(">4f", *(float(x * given.step) for x in p), 1.0)
    # Old BGEO ends with two bytes: an attribute-less detail.
    out += b"\x00\xff"
    with open(given.target, "wb") as file:
        file.write(gzip.compress(bytes(out), 9, mtime=0))


if __name__ == "__main__":
    main()
