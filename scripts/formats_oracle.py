#!/usr/bin/env python3
"""Writes the same particles with other people's writers, in each form that these have, and lets a test read
them back: `scripts/formats_oracle.py FOLDER`. Needs numpy, vtk and meshio from Python's package index.

The values are such that a careless conversion changes them. Beside the files lie the values as raw numbers;
the test `oracle` of `tests/formats.rs` compares every file of the folder with those, bit for bit.
"""

import itertools
import os
import pathlib
import subprocess
import sys

import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

COUNT = 1234


def sample():
    random = np.random.default_rng(7)
    bits = random.integers(0, 2**32, COUNT * 6, dtype=np.uint64).astype(np.uint32).view(np.float32)
    bits = np.where(np.isfinite(bits), bits, np.float32(0.1)).astype(np.float32)
    return {
        "position": bits[: COUNT * 3].reshape(-1, 3),
        "velocity": bits[COUNT * 3 :].reshape(-1, 3),
        "id": random.integers(-(2**31), 2**31, COUNT).astype(np.int32),
        "mass": random.standard_normal(COUNT),
    }


def vtk_data(values, poly):
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(values["position"], deep=True))
    data = vtk.vtkPolyData() if poly else vtk.vtkUnstructuredGrid()
    data.SetPoints(points)
    cells = vtk.vtkCellArray()
    for i in range(len(values["position"])):
        cells.InsertNextCell(1, [i])
    data.SetVerts(cells) if poly else data.SetCells(vtk.VTK_VERTEX, cells)
    for name in ("velocity", "id", "mass"):
        array = numpy_to_vtk(values[name], deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def legacy(folder, values):
    for poly, binary, version in itertools.product((0, 1), (0, 1), (42, 51)):
        writer = vtk.vtkPolyDataWriter() if poly else vtk.vtkUnstructuredGridWriter()
        writer.SetInputData(vtk_data(values, poly))
        writer.SetFileVersion(version)
        writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
        path = folder / f"legacy_{'poly' if poly else 'grid'}_{'binary' if binary else 'text'}_{version}.vtk"
        writer.SetFileName(str(path))
        assert writer.Write()
        if version == 42:
            # Version 3 differs in the number only.
            old = path.read_bytes().replace(b"Version 4.2", b"Version 3.0", 1)
            path.with_name(path.name.replace("_42", "_30")).write_bytes(old)


def xml(folder, values):
    modes = {"text": None, "inline": "SetDataModeToBinary", "appended": "SetDataModeToAppended"}
    packings = {"none": None, "zlib": vtk.vtkZLibDataCompressor, "lz4": vtk.vtkLZ4DataCompressor}
    for poly, mode, packing, wide, base64, big in itertools.product(
        (0, 1), modes, packings, (0, 1), (0, 1), (0, 1)
    ):
        if (mode != "appended" and base64) or (mode == "text" and (packing != "none" or wide or big)):
            continue
        writer = vtk.vtkXMLPolyDataWriter() if poly else vtk.vtkXMLUnstructuredGridWriter()
        writer.SetInputData(vtk_data(values, poly))
        getattr(writer, modes[mode] or "SetDataModeToAscii")()
        writer.SetCompressor(packings[packing]() if packings[packing] else None)
        writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
        writer.SetEncodeAppendedData(base64)
        writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
        # Several blocks to an array.
        writer.SetBlockSize(4096)
        name = f"xml_{mode}_{packing}_{64 if wide else 32}_{'base64' if base64 else 'raw'}_{'big' if big else 'little'}"
        writer.SetFileName(str(folder / f"{name}.{'vtp' if poly else 'vtu'}"))
        assert writer.Write()


def with_meshio(folder, values):
    cells = [("vertex", np.arange(COUNT).reshape(-1, 1))]
    data = {name: values[name] for name in ("velocity", "id", "mass")}
    mesh = meshio.Mesh(values["position"], cells, point_data=data)
    for kind, ends, options in [
        ("vtk42", "vtk", {"binary": True}), ("vtk42", "vtk", {"binary": False}),
        ("vtk51", "vtk", {"binary": True}), ("vtk51", "vtk", {"binary": False}),
        ("vtu", "vtu", {"binary": True, "compression": "zlib"}), ("vtu", "vtu", {"binary": True, "compression": None}),
        ("vtu", "vtu", {"binary": False}),
    ]:
        name = "_".join(["meshio", kind, *(str(option) for option in options.values())])
        meshio.write(folder / f"{name}.{ends}", mesh, kind, **options)
    # Only single numbers go into this writer's PLY files.
    single = {"id": values["id"], "mass": values["mass"]}
    single |= {f"v{axis}": values["velocity"][:, i] for i, axis in enumerate("xyz")}
    for binary in (True, False):
        ply = meshio.Mesh(values["position"], [], point_data=single)
        meshio.write(folder / f"meshio_{'binary' if binary else 'text'}.ply", ply, "ply", binary=binary)


def with_numpy(folder, values):
    values["position"].tofile(folder / "raw.xyz")
    np.savetxt(folder / "text.xyz", values["position"], fmt="%.9g")
    columns = [values["position"], values["velocity"], values["id"][:, None], values["mass"][:, None]]
    header = "x,y,z,velocity_x,velocity_y,velocity_z,id,mass"
    kinds = ["%.9g"] * 6 + ["%d", "%.17g"]
    np.savetxt(folder / "text.csv", np.hstack(columns), kinds, ",", header=header, comments="")
    import json

    rows = {name: values[name].astype(np.float64 if name != "id" else np.int64).tolist() for name in values}
    (folder / "columns.json").write_text(json.dumps(rows))
    objects = [{name: rows[name][i] for name in rows} for i in range(COUNT)]
    (folder / "objects.json").write_text(json.dumps(objects, indent=1))


def keep_what_text_keeps(folder):
    """Some writers round in text files: there the values to expect are what an independent reader finds."""
    for path in folder.glob("legacy_*_text_*.vtk"):
        reader = vtk.vtkGenericDataObjectReader()
        reader.SetFileName(str(path))
        reader.Update()
        found = reader.GetOutput()
        columns = {"position": vtk_to_numpy(found.GetPoints().GetData())}
        columns |= {n: vtk_to_numpy(found.GetPointData().GetArray(n)) for n in ("velocity", "mass")}
        keep(folder, path, columns)
    path = folder / "meshio_vtu_False.vtu"
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    mass = vtk_to_numpy(reader.GetOutput().GetPointData().GetArray("mass"))
    keep(folder, path, {"mass": mass})


def keep(folder, path, columns):
    for name, column in columns.items():
        kind = np.float64 if name == "mass" else np.float32
        np.asarray(column).astype(kind).tofile(folder / f"{path.name}.{name}.values")


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    values = sample()
    for write in (legacy, xml, with_meshio, with_numpy):
        write(folder, values)
    keep_what_text_keeps(folder)
    for name, column in values.items():
        column.tofile(folder / f"{name}.values")
    test = ["cargo", "test", "--test", "formats", "oracle", "--", "--nocapture"]
    return subprocess.call(test, env=os.environ | {"MENISCUS_ORACLE": str(folder.resolve())})


if __name__ == "__main__":
    sys.exit(main())
