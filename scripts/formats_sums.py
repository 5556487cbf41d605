#!/usr/bin/env python3
"""Reads particle files of other programs with other people's readers and prints what is in them, a line for each attribute:
`scripts/formats_sums.py FOLDER > tests/formats/sums.txt`. Needs numpy and vtk from Python's package index; for BGEO, which these do
not read, the file's layout is walked here in the simplest way.

A line has the file, the attribute, its components, and the CRC-32 of all values as little-endian numbers of 64 bits; the test
`sums` of `tests/formats.rs` holds the program's own readers against it.
"""

import gzip
import pathlib
import struct
import sys
import zlib

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

READERS = {
    ".vtk": vtk.vtkGenericDataObjectReader,
    ".vtu": vtk.vtkXMLUnstructuredGridReader,
    ".ply": vtk.vtkPLYReader,
}


def with_vtk(path):
    reader = READERS[path.suffix]()
    reader.SetFileName(str(path))
    for all_of in ("ReadAllScalarsOn", "ReadAllVectorsOn", "ReadAllFieldsOn"):
        getattr(reader, all_of, lambda: None)()
    reader.Update()
    found = reader.GetOutput()
    columns = {"position": vtk_to_numpy(found.GetPoints().GetData())}
    data = found.GetPointData()
    for i in range(data.GetNumberOfArrays()):
        columns[data.GetArrayName(i)] = vtk_to_numpy(data.GetArray(i))
    return columns


def bgeo(path):
    content = path.read_bytes()
    if content[:2] == b"\x1f\x8b":
        content = gzip.decompress(content)
    assert content[:5] == b"BgeoV"
    _, points, _, _, _, attributes, *_ = struct.unpack_from(">9i", content, 5)
    at, layout = 5 + 9 * 4, [("position", ">f4", 4)]
    for _ in range(attributes):
        (length,) = struct.unpack_from(">H", content, at)
        name = content[at + 2 : at + 2 + length].decode()
        size, kind = struct.unpack_from(">Hi", content, at + 2 + length)
        at += 2 + length + 6 + 4 * size
        layout.append((name, {0: ">f4", 1: ">i4", 5: ">f4"}[kind], size))
    rows = np.frombuffer(content, np.dtype([(name, kind, size) for name, kind, size in layout]), points, at)
    columns = {name: rows[name] for name, _, _ in layout}
    # Homogeneous: the fourth is 1.
    assert (columns["position"][:, 3] == 1.0).all()
    columns["position"] = columns["position"][:, :3]
    return columns


def raw(path):
    return {"position": np.fromfile(path, "<f4").reshape(-1, 3)}


def main():
    folder = pathlib.Path(sys.argv[1])
    for path in sorted(folder.rglob("*")):
        read = {".bgeo": bgeo, ".xyz": raw}.get(path.suffix, with_vtk if path.suffix in READERS else None)
        # A surface, not particles.
        if read is None or "obstacle" in path.name:
            continue
        for name, values in sorted(read(path).items()):
            values = np.asarray(values).reshape(len(values), -1)
            crc = zlib.crc32(values.astype("<f8").tobytes())
            print(path.relative_to(folder).as_posix(), name, values.shape[1], f"{crc:08x}")


if __name__ == "__main__":
    main()
