#!/usr/bin/env python3
"""Writes the meshes that scenes use into scenes/assets. They are original work of this project.

Lengths are metres, y is up, fronts are counter-clockwise. Nothing but Python's own library is
needed, and the same files come out each time.
"""

import json
import math
import struct
import zlib
from pathlib import Path

OUT = Path(__file__).resolve().parent.parent / "scenes" / "assets"


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scale(a, s):
    return tuple(x * s for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return scale(a, 1 / length) if length > 1e-12 else (0.0, 1.0, 0.0)


class Mesh:
    """Vertices with position, normal and texture coordinates (v downwards), and polygons."""

    def __init__(self):
        self.positions, self.normals, self.uvs, self.faces = [], [], [], []

    def vertex(self, position, normal, uv):
        self.positions.append(position)
        self.normals.append(unit(normal))
        self.uvs.append(uv)
        return len(self.positions) - 1

    def triangles(self):
        for face in self.faces:
            for at in range(1, len(face) - 1):
                corners = (face[0], face[at], face[at + 1])
                points = [self.positions[c] for c in corners]
                area = cross(sub(points[1], points[0]), sub(points[2], points[0]))
                if sum(x * x for x in area) > 1e-18:
                    yield corners

    def grid(self, rows, columns, point, normal, uv):
        """A sheet of quads over (row, column); `point` and the others take both as fractions."""
        first = len(self.positions)
        for r in range(rows + 1):
            for c in range(columns + 1):
                u, v = c / columns, r / rows
                self.vertex(point(u, v), normal(u, v), uv(u, v))
        wide = columns + 1
        for r in range(rows):
            for c in range(columns):
                at = first + r * wide + c
                self.faces.append((at, at + wide, at + wide + 1, at + 1))


def rounded_block(size, radius, steps):
    """A box whose edges and corners are rounded: six sheets, finer where they bend."""
    mesh = Mesh()
    half = scale(size, 0.5)
    inner = tuple(h - radius for h in half)
    # The places along a side: its rounded ends, with the plane between them.
    ends = [(-1, math.pi / 4 * (1 - k / steps)) for k in range(steps + 1)]
    ends += [(1, math.pi / 4 * k / steps) for k in range(steps + 1)]
    for axis in range(3):
        for sign in (-1, 1):
            a, b = (axis + 1) % 3, (axis + 2) % 3
            if sign < 0:
                a, b = b, a

            def place(i, j):
                (sa, angle_a), (sb, angle_b) = ends[i], ends[j]
                direction = [0.0] * 3
                direction[axis] = sign
                direction[a] = sa * math.tan(angle_a)
                direction[b] = sb * math.tan(angle_b)
                normal = unit(tuple(direction))
                base = [0.0] * 3
                base[axis] = sign * inner[axis]
                base[a], base[b] = sa * inner[a], sb * inner[b]
                point = add(tuple(base), scale(normal, radius))
                return point, normal, (0.5 + point[a] / size[a], 0.5 - point[b] / size[b])

            first, wide = len(mesh.positions), len(ends)
            for j in range(wide):
                for i in range(wide):
                    mesh.vertex(*place(i, j))
            for j in range(wide - 1):
                for i in range(wide - 1):
                    at = first + j * wide + i
                    mesh.faces.append((at, at + 1, at + wide + 1, at + wide))
    return mesh


def torus(ring, tube, rows, columns):
    mesh = Mesh()

    def direction(u, v):
        turn, tilt = 2 * math.pi * u, 2 * math.pi * v
        return (math.cos(turn) * math.cos(tilt), -math.sin(tilt), -math.sin(turn) * math.cos(tilt))

    def point(u, v):
        turn = 2 * math.pi * u
        return add((ring * math.cos(turn), 0.0, -ring * math.sin(turn)), scale(direction(u, v), tube))

    mesh.grid(rows, columns, point, direction, lambda u, v: (4 * u, v))
    return mesh


def lathe(profile, columns, mesh=None, turns=1.0):
    """Turns a profile of (radius, height, is_sharp), from the top down, around the axis y."""
    mesh = mesh or Mesh()
    lengths = [0.0]
    for (r0, y0, _), (r1, y1, _) in zip(profile, profile[1:]):
        lengths.append(lengths[-1] + math.hypot(r1 - r0, y1 - y0))

    def slope(a, b):
        (r0, y0, _), (r1, y1, _) = profile[a], profile[b]
        return unit((y0 - y1, r1 - r0, 0.0))

    for at in range(len(profile) - 1):
        normals = []
        for end, other in ((at, at - 1), (at + 1, at + 2)):
            here = slope(at, at + 1)
            if not profile[end][2] and 0 <= other < len(profile):
                here = unit(add(here, slope(min(end, other), max(end, other))))
            normals.append(here)
        ends = (profile[at], profile[at + 1])

        def point(u, v):
            radius, height, _ = ends[round(v)]
            return (radius * math.cos(2 * math.pi * u), height, -radius * math.sin(2 * math.pi * u))

        def normal(u, v):
            out, up, _ = normals[round(v)]
            return (out * math.cos(2 * math.pi * u), up, -out * math.sin(2 * math.pi * u))

        mesh.grid(1, columns, point, normal, lambda u, v: (turns * u, lengths[at + round(v)] / lengths[-1]))
    return mesh


def arc(middle, radius, start, end, steps, sharp_ends=(False, False)):
    """Points of a profile on a part of a circle, in degrees from the axis."""
    points = []
    for k in range(steps + 1):
        angle = math.radians(start + (end - start) * k / steps)
        is_sharp = (k == 0 and sharp_ends[0]) or (k == steps and sharp_ends[1])
        points.append((max(0.0, middle[0] + radius * math.sin(angle)), middle[1] + radius * math.cos(angle), is_sharp))
    return points


def pillar():
    top = [(0.0, 1.2, False), (0.15, 1.2, True), (0.15, 1.12, True), (0.12, 1.12, True)]
    shaft = [(0.105, 1.06, False), (0.1, 0.9, False), (0.1, 0.3, False), (0.105, 0.14, False), (0.12, 0.08, True)]
    return lathe(top + shaft + [(0.16, 0.08, True), (0.16, 0.0, True), (0.0, 0.0, False)], 32)


def buoy():
    """A float with stripes, and the lamp that stands on it."""
    body = [(0.0, 0.2, False), (0.03, 0.2, True), (0.03, 0.1, True)]
    body += arc((0.0, 0.0), 0.104, 17, 180, 14, (True, False))
    body[3] = (0.03, 0.1, True)
    return lathe(body, 24, turns=1.0), lathe(arc((0.0, 0.0), 0.028, 0, 180, 8), 16)


def boat():
    """A rowing boat from sections along its keel: hull, inside and rim."""
    length, beam, depth, wall, rows, columns = 0.6, 0.22, 0.1, 0.012, 12, 24

    def half(u):
        # Full behind, pointed ahead.
        return beam / 2 * (1 - max(0.0, (u - 0.35) / 0.65) ** 2.2) * (0.8 + 0.2 * min(1.0, u / 0.35))

    def keel(u):
        return -depth * (1 - 0.55 * max(0.0, (u - 0.55) / 0.45) ** 2)

    def sheer(u):
        return 0.02 + 0.05 * (u - 0.4) ** 2 / 0.36

    def section(u, v, inset):
        angle = math.pi * v
        wide = max(half(u) - inset, 0.0)
        low = min(keel(u) + inset, sheer(u) - 0.004)
        side = math.cos(angle)
        z = -wide * math.copysign(abs(side) ** 0.8, side)
        y = sheer(u) + (low - sheer(u)) * math.sin(angle) ** 0.75
        return (length * (u - 0.5), y, z)

    outer = lambda u, v: section(u, v, 0.0)
    inner = lambda u, v: section(min(max(u, 0.03), 0.93), v, wall)
    mesh = Mesh()

    def turned(first, is_turned):
        if is_turned:
            mesh.faces[first:] = [tuple(reversed(face)) for face in mesh.faces[first:]]

    def sheet(point, is_turned, uv):
        def normal(u, v):
            e = 1e-3
            along = sub(point(min(u + e, 1), v), point(max(u - e, 0), v))
            across = sub(point(u, min(v + e, 1)), point(u, max(v - e, 0)))
            found = cross(across, along)
            return scale(found, -1) if is_turned else found

        first = len(mesh.faces)
        mesh.grid(rows, columns, point, normal, uv)
        turned(first, is_turned)

    def flat(r, c, point, facing, is_turned, uv):
        first = len(mesh.faces)
        mesh.grid(r, c, point, lambda u, v: facing, uv)
        turned(first, is_turned)

    def between(a, b, t):
        return add(scale(a, 1 - t), scale(b, t))

    sheet(outer, True, lambda u, v: (u, v))
    sheet(inner, False, lambda u, v: (u, v))
    up = (0.0, 1.0, 0.0)
    for side, is_turned in ((0.0, False), (1.0, True)):
        rim = lambda u, t, v=side: between(outer(u, v), inner(u, v), t)
        flat(1, columns, rim, up, is_turned, lambda u, t: (u, 0.02 * t))
    for end, ahead in ((0.0, False), (1.0, True)):
        # The stern and the bow: their outside, their inside, and the rim between.
        for shell, is_inside in ((outer, False), (inner, True)):
            cap = lambda w, d, s=shell, u=end: between(s(u, d / 2), s(u, 1 - d / 2), w)
            faces_bow = ahead != is_inside
            facing = (1.0, 0.0, 0.0) if faces_bow else (-1.0, 0.0, 0.0)
            flat(rows // 2, 1, cap, facing, faces_bow, lambda w, d: (w, 0.25 + d / 4))
        rim = lambda a, t, u=end: between(between(outer(u, 0), outer(u, 1), a), between(inner(u, 0), inner(u, 1), a), t)
        flat(1, 1, rim, up, not ahead, lambda a, t: (a, 0.02 * t))
    return mesh


def obj(name, mesh, about, material):
    lines = [f"# {about}", "# Made by scripts/make_assets.py.", f"mtllib {name}.mtl", f"usemtl {name}"]
    lines += ["v %.5g %.5g %.5g" % p for p in mesh.positions]
    lines += ["vt %.4g %.4g" % (u, 1 - v) for u, v in mesh.uvs]
    lines += ["vn %.4g %.4g %.4g" % n for n in mesh.normals]
    for face in mesh.faces:
        kept = []
        for corner in face:
            if not any(mesh.positions[corner] == mesh.positions[k] for k in kept):
                kept.append(corner)
        if len(kept) > 2:
            lines.append("f " + " ".join(f"{c + 1}/{c + 1}/{c + 1}" for c in kept))
    (OUT / f"{name}.obj").write_text("\n".join(lines) + "\n")
    (OUT / f"{name}.mtl").write_text(f"newmtl {name}\n{material}\n")


def png(width, height, texel):
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(width)) for y in range(height))

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


class Glb:
    """A binary glTF under construction."""

    def __init__(self):
        self.binary = b""
        self.document = {
            "asset": {"version": "2.0", "generator": "scripts/make_assets.py"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [], "buffers": [],
        }

    def put(self, name, value):
        self.document.setdefault(name, []).append(value)
        return len(self.document[name]) - 1

    def view(self, content):
        self.binary += b"\0" * (-len(self.binary) % 4)
        start = len(self.binary)
        self.binary += content
        return self.put("bufferViews", {"buffer": 0, "byteOffset": start, "byteLength": len(content)})

    def accessor(self, shape, rows, code, kind, has_bounds=False):
        flat = [x for row in rows for x in (row if isinstance(row, tuple) else (row,))]
        made = {"bufferView": self.view(struct.pack(f"<{len(flat)}{code}", *flat)), "componentType": kind,
                "count": len(rows), "type": shape}
        if has_bounds:
            columns = list(zip(*(row if isinstance(row, tuple) else (row,) for row in rows)))
            made["min"], made["max"] = ([f32(f(c)) for c in columns] for f in (min, max))
        return self.put("accessors", made)

    def mesh(self, name, mesh, material):
        attributes = {
            "POSITION": self.accessor("VEC3", mesh.positions, "f", 5126, True),
            "NORMAL": self.accessor("VEC3", mesh.normals, "f", 5126),
            "TEXCOORD_0": self.accessor("VEC2", mesh.uvs, "f", 5126),
        }
        corners = [corner for triangle in mesh.triangles() for corner in triangle]
        indices = self.accessor("SCALAR", corners, "H", 5123)
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        return self.put("meshes", {"name": name, "primitives": [primitive]})

    def picture(self, content):
        image = self.put("images", {"bufferView": self.view(content), "mimeType": "image/png"})
        return {"index": self.put("textures", {"source": image})}

    def write(self, name):
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
        (OUT / name).write_bytes(struct.pack("<4sII", b"glTF", 2, len(body) + 12) + body)


def f32(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def noise(x, y):
    value = math.sin(x * 12.9898 + y * 78.233) * 43758.5453
    return value - math.floor(value)


def crate(x, y):
    """A side of a wooden box, 64 by 64: boards in a frame with nails."""
    edge = min(x, y, 63 - x, 63 - y)
    grain = 0.1 * noise(x // 5, y) + 0.05 * noise(x, y)
    if edge < 9:
        # The frame's boards lie along the sides, those above and below between the others.
        is_upright = min(x, 63 - x) < 9
        grain = 0.1 * noise(x, y // 5) + 0.05 * noise(x, y) if is_upright else grain
        shade = 0.92 + grain - (0.45 if edge == 8 else 0.0) - (0.3 if not is_upright and x in (9, 54) else 0.0)
        is_nail = min(x, 63 - x) in (3, 4, 5) and min(y, 63 - y) in (12, 13, 30, 31)
        return (92, 88, 84) if is_nail else tuple(round(min(255, c * shade)) for c in (206, 150, 92))
    board = (y - 9) // 9
    shade = 0.62 + 0.22 * noise(3, board) + grain - (0.32 if (y - 9) % 9 == 0 else 0.0)
    return tuple(round(min(255, c * shade)) for c in (196, 134, 78))


def stripes_of_ring(x, y):
    """A quarter of a swimming ring, 64 by 32: red and white, with a dark seam between and along the inside."""
    worn = 10 * noise(x, y)
    if x % 32 in (0, 31) or y == 16:
        return tuple(round(c - worn) for c in (150, 120, 104))
    return tuple(round(c - worn) for c in ((214, 52, 30) if x < 32 else (244, 238, 226)))


def write_buoy():
    file = Glb()
    body, lamp = buoy()

    def stripes(x, y):
        # White above and below a red belt, with a dark line of weed where the float lies in.
        worn = 14 * noise(x, y)
        if 26 < y < 40:
            return (round(196 - worn), round(28 + worn / 2), round(24 + worn / 2))
        if y > 46:
            return (round(70 - worn), round(82 - worn), round(70 - worn))
        return (round(236 - worn), round(234 - worn), round(226 - worn))

    picture = file.picture(png(8, 64, stripes))
    paint = {"baseColorTexture": picture, "metallicFactor": 0, "roughnessFactor": 0.45}
    painted = file.put("materials", {"name": "paint", "pbrMetallicRoughness": paint})
    glass = {"baseColorFactor": [1, 0.75, 0.2, 1], "metallicFactor": 0, "roughnessFactor": 0.1}
    glowing = {"name": "lamp", "pbrMetallicRoughness": glass, "emissiveFactor": [1, 0.6, 0.15]}
    lit = file.put("materials", glowing)
    file.put("nodes", {"name": "buoy", "children": [1, 2]})
    file.put("nodes", {"name": "body", "mesh": file.mesh("body", body, painted)})
    file.put("nodes", {"name": "lamp", "mesh": file.mesh("lamp", lamp, lit), "translation": [0, 0.225, 0]})
    # It sways around its middle: a quarter to each side of a turn of 24 degrees, in 4 seconds.
    times = [0.0, 1.0, 2.0, 3.0, 4.0]
    half = [0.0, math.radians(6), 0.0, math.radians(-6), 0.0]
    keys = [(0.0, 0.0, math.sin(h), math.cos(h)) for h in half]
    sampler = {"input": file.accessor("SCALAR", times, "f", 5126, True), "output": file.accessor("VEC4", keys, "f", 5126)}
    channel = {"sampler": 0, "target": {"node": 0, "path": "rotation"}}
    file.put("animations", {"name": "sway", "samplers": [sampler], "channels": [channel]})
    file.write("buoy.glb")


def write_boat():
    file = Glb()

    def planks(x, y):
        # Planks along the boat, each of its own brown, with dark seams and grain.
        seam = y % 8 == 0
        shade = 0.75 + 0.25 * noise(7, y // 8) + 0.08 * noise(x // 3, y) - (0.35 if seam else 0.0)
        return tuple(round(min(255, c * shade)) for c in (168, 112, 62))

    picture = file.picture(png(32, 64, planks))
    wood = {"baseColorTexture": picture, "metallicFactor": 0, "roughnessFactor": 0.6}
    material = file.put("materials", {"name": "wood", "pbrMetallicRoughness": wood})
    file.put("nodes", {"name": "boat", "mesh": file.mesh("boat", boat(), material)})
    file.write("boat.glb")


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    obj("block", rounded_block((0.4, 0.4, 0.4), 0.04, 4), "A block with rounded edges", "Kd 1 1 1\nmap_Kd block.png\nPr 0.8")
    (OUT / "block.png").write_bytes(png(64, 64, crate))
    obj("pillar", pillar(), "A pillar with a foot and a head", "Kd 0.62 0.58 0.5\nPr 0.7")
    obj("ring", torus(0.25, 0.08, 16, 32), "A ring", "Kd 1 1 1\nmap_Kd ring.png\nPr 0.35")
    (OUT / "ring.png").write_bytes(png(64, 32, stripes_of_ring))
    write_buoy()
    write_boat()


if __name__ == "__main__":
    main()
