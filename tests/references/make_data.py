#!/usr/bin/env python3
"""Writes the small images and meshes of data/. Needs numpy and Mitsuba 3 (for the image codecs)."""

import pathlib
import struct
import zlib

import mitsuba as mi
import numpy as np

DATA = pathlib.Path(__file__).parent / "data"


def pattern(width, height):
    """A colour gradient with a white letter F and a dark corner: no symmetry hides a flipped axis."""
    y, x = np.mgrid[0:height, 0:width]
    image = np.stack([0.25 + 0.6 * x / (width - 1), 0.3 + 0.5 * y / (height - 1),
                      0.75 - 0.4 * x / (width - 1)], -1)
    f = np.zeros((height, width), bool)
    f[2:height - 2, 3:5] = True
    f[2:4, 3:width - 4] = True
    f[height // 2 - 1:height // 2 + 1, 3:width - 7] = True
    image[f] = 0.95
    image[height - 3:, width - 3:] = 0.1
    return image.astype(np.float32)


def smooth_pattern(width, height):
    """Slow waves without dark colours: JPEG decoders then agree closely."""
    y, x = np.mgrid[0:height, 0:width]
    u, v = (x + 0.5) / width, (y + 0.5) / height
    return np.stack([0.7 + 0.2 * np.cos(6 * u), 0.65 + 0.2 * np.sin(5 * v),
                     0.6 + 0.15 * np.cos(4 * (u - v))], -1).astype(np.float32)


def to_bytes(image):
    return (np.clip(image, 0, 1) * 255 + 0.5).astype(np.uint8)


def write_bmp(path, rgb):
    """24 bits, rows from the bottom, padded to 4 bytes."""
    height, width, _ = rgb.shape
    row = (3 * width + 3) // 4 * 4
    body = b"".join(rgb[y, :, ::-1].tobytes().ljust(row, b"\0") for y in range(height - 1, -1, -1))
    head = struct.pack("<2sIHHI", b"BM", 54 + len(body), 0, 0, 54)
    info = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, len(body), 2835, 2835, 0, 0)
    path.write_bytes(head + info + body)


def write_tga(path, rgb):
    """24 bits, uncompressed, rows from the bottom, with the footer of version 2."""
    height, width, _ = rgb.shape
    head = struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, width, height, 24, 0)
    foot = struct.pack("<II18s", 0, 0, b"TRUEVISION-XFILE.\0")
    path.write_bytes(head + rgb[::-1, :, ::-1].tobytes() + foot)


def write_images():
    image = pattern(16, 12)
    rgb = to_bytes(image)
    mi.Bitmap(rgb).write(str(DATA / "pattern.png"))
    write_bmp(DATA / "pattern.bmp", rgb)
    write_tga(DATA / "pattern.tga", rgb)
    mi.Bitmap(to_bytes(smooth_pattern(24, 16))).write(str(DATA / "waves.jpg"), quality=95)
    alpha = np.concatenate([rgb, np.full((12, 16, 1), 90, np.uint8)], -1)
    mi.Bitmap(alpha).write(str(DATA / "pattern_rgba.png"))
    grey = to_bytes(smooth_pattern(9, 7))[:, :, :1]
    mi.Bitmap(grey).write(str(DATA / "grey.png"))
    mi.Bitmap(image).write(str(DATA / "pattern.exr"))
    mi.Bitmap(image).write(str(DATA / "pattern.pfm"))
    mi.Bitmap(image).write(str(DATA / "pattern.hdr"))
    mi.Bitmap(4 * pattern(16, 12) ** 2).write(str(DATA / "glow.exr"))


def write_maps():
    """A height that repeats, of 8 bits, and the normals of its surface as colours."""
    height, width = 12, 16
    y, x = np.mgrid[0:height, 0:width] * 2 * np.pi
    u, v = x / width, y / height
    heights = 0.5 + 0.25 * np.sin(2 * u + 1) + 0.2 * np.sin(u - 3 * v)
    mi.Bitmap(to_bytes(heights[:, :, None])).write(str(DATA / "heights.png"))
    normals = np.stack([-0.5 * np.cos(2 * u + 1) - 0.3 * np.cos(u - 3 * v), 0.6 * np.cos(u - 3 * v),
                        np.ones_like(u)], -1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    mi.Bitmap(to_bytes(0.5 + 0.5 * normals)).write(str(DATA / "normals.png"))


def write_environment():
    """A sky that is brighter above, a coloured horizon, and a sun of 2 x 2 pixels."""
    height, width = 17, 32
    y, x = np.mgrid[0:height, 0:width]
    v, u = y / (height - 1), (x + 0.5) / width
    sky = np.stack([0.3 + 0.3 * v, 0.4 + 0.1 * np.sin(2 * np.pi * u), 0.8 - 0.5 * v], -1)
    sky[y > height // 2] *= 0.4
    sky[4:6, 6:8] += [60, 50, 35]
    mi.Bitmap(sky.astype(np.float32)).write(str(DATA / "sky.exr"))
    mi.Bitmap(to_bytes(smooth_pattern(12, 7))).write(str(DATA / "sky.png"))


def blob(rings=7, sectors=11):
    """A lumpy closed ball: positions, unit normals (of the smooth surface), uv, triangles."""
    i, j = np.mgrid[0:rings + 1, 0:sectors + 1]
    theta, phi = np.pi * i / rings, 2 * np.pi * j / sectors

    def surface(t, p):
        r = 1 + 0.18 * np.sin(3 * t) * np.cos(2 * p)
        return np.stack([r * np.sin(t) * np.cos(p), r * np.sin(t) * np.sin(p), 1.1 * r * np.cos(t)], -1)

    points = surface(theta, phi)
    step = 1e-5
    inner = np.clip(theta, 1e-3, np.pi - 1e-3)
    normals = np.cross(surface(inner + step, phi) - surface(inner - step, phi),
                       surface(inner, phi + step) - surface(inner, phi - step))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    uvs = np.stack([j / sectors, i / rings], -1)
    triangles = []
    for r in range(rings):
        for s in range(sectors):
            a, b = r * (sectors + 1) + s, r * (sectors + 1) + s + 1
            c, d = a + sectors + 1, b + sectors + 1
            if r < rings - 1:
                triangles.append((a, c, d))
            if r > 0:
                triangles.append((a, d, b))
    return points.reshape(-1, 3), normals.reshape(-1, 3), uvs.reshape(-1, 2), np.array(triangles)


def write_obj(name, points, triangles, normals=None, uvs=None):
    lines = ["v %.5g %.5g %.5g" % tuple(p) for p in points]
    lines += ["vt %.5g %.5g" % tuple(t) for t in ([] if uvs is None else uvs)]
    lines += ["vn %.5g %.5g %.5g" % tuple(n) for n in ([] if normals is None else normals)]
    for triangle in triangles + 1:
        corner = ["%d%s%s" % (k, "/%s" % ("" if uvs is None else k) if normals is not None or
                              uvs is not None else "", "" if normals is None else "/%d" % k)
                  for k in triangle]
        lines.append("f " + " ".join(corner))
    (DATA / name).write_text("\n".join(lines) + "\n")


def write_ply(name, form, points, triangles, normals=None, uvs=None):
    columns = [("x y z", points), ("nx ny nz", normals), ("u v", uvs)]
    columns = [(names, values) for names, values in columns if values is not None]
    properties = ["property float " + n for names, _ in columns for n in names.split()]
    header = ["ply", "format %s 1.0" % form, "element vertex %d" % len(points), *properties,
              "element face %d" % len(triangles), "property list uchar int vertex_indices",
              "end_header", ""]
    rows = np.concatenate([values for _, values in columns], 1)
    if form == "ascii":
        body = "\n".join(" ".join("%.5g" % x for x in row) for row in rows) + "\n"
        body += "\n".join("3 %d %d %d" % tuple(t) for t in triangles) + "\n"
        data = body.encode()
    else:
        order = "<" if "little" in form else ">"
        data = rows.astype(order + "f4").tobytes()
        data += b"".join(struct.pack(order + "B3i", 3, *t) for t in triangles)
    (DATA / name).write_bytes("\n".join(header).encode() + data)


def welded(points, triangles):
    """One vertex per place, so that computed normals are smooth across seam and poles."""
    _, first, index = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    return points[first], index.reshape(-1)[triangles]


def write_attributes(name, points, triangles, normals):
    """A mesh with a colour and two numbers by vertex, and a colour and a number by face."""
    x, y, z = points.T
    middle = points[triangles].mean(1)
    of_vertices = [("x y z", points), ("nx ny nz", normals),
                   ("red green blue", 0.5 + 0.4 * np.stack([x, np.sin(3 * y), -z], -1)),
                   ("height_0", 0.5 + 0.3 * np.sin(2 * x + y)[:, None]),
                   ("tint_r tint_g tint_b", 0.6 + 0.3 * np.stack([np.cos(4 * z), x * y, y], -1))]
    of_faces = [("r g b", 0.5 + 0.35 * np.sin(3 * middle)),
                ("rough_x", 0.3 + 0.2 * np.sin(5 * middle[:, :1]))]
    header = ["ply", "format ascii 1.0", "element vertex %d" % len(points)]
    header += ["property float " + n for names, _ in of_vertices for n in names.split()]
    header += ["element face %d" % len(triangles), "property list uchar int vertex_indices"]
    header += ["property float " + n for names, _ in of_faces for n in names.split()]
    rows = np.concatenate([values for _, values in of_vertices], 1)
    values = np.concatenate([values for _, values in of_faces], 1)
    lines = header + ["end_header"] + [" ".join("%.4g" % v for v in row) for row in rows]
    lines += ["3 %d %d %d " % tuple(t) + " ".join("%.4g" % v for v in row)
              for t, row in zip(triangles, values)]
    (DATA / name).write_text("\n".join(lines) + "\n")


def serialized(points, triangles, precision, version, normals=None, uvs=None, colors=None):
    """A mesh as it stands in a .serialized file."""
    data = [values for values in (points, normals, uvs, colors) if values is not None]
    flags = (normals is not None) | (uvs is not None) << 1 | (colors is not None) << 3
    flags |= 0x2000 if precision == "<f8" else 0x1000
    body = struct.pack("<I", flags) + (b"mesh\0" if version == 4 else b"")
    body += struct.pack("<QQ", len(points), len(triangles))
    body += b"".join(values.astype(precision).tobytes() for values in data)
    body += triangles.astype("<u4").tobytes()
    return struct.pack("<HH", 0x041C, version) + zlib.compress(body, 9)


def write_serialized(name, version, meshes):
    places = np.cumsum([0] + [len(mesh) for mesh in meshes[:-1]])
    (DATA / name).write_bytes(b"".join(meshes) + places.astype("<u8" if version == 4 else "<u4").tobytes() +
                              struct.pack("<I", len(meshes)))


def write_meshes():
    points, normals, uvs, triangles = blob()
    bare, bare_triangles = welded(points, triangles)
    write_obj("blob.obj", points, triangles, normals, uvs)
    write_obj("blob_bare.obj", bare, bare_triangles)
    write_ply("blob_ascii.ply", "ascii", points, triangles, normals, uvs)
    write_ply("blob_little.ply", "binary_little_endian", bare, bare_triangles)
    write_ply("blob_big.ply", "binary_big_endian", points, triangles, normals, uvs)
    points, normals, uvs, triangles = blob(4, 6)
    write_obj("gem.obj", points, triangles, normals, uvs)
    write_attributes("gem_attributes.ply", points, triangles, normals)
    bare, bare_triangles = welded(points, triangles)
    write_serialized("gems.serialized", 4, [
        serialized(bare, bare_triangles, "<f4", 4),
        serialized(points, triangles, "<f8", 4, normals, uvs, 0.5 + 0.4 * np.sin(3 * points))])
    write_serialized("gems_3.serialized", 3, [
        serialized(points, triangles, "<f4", 3, normals, uvs),
        serialized(bare, bare_triangles, "<f8", 3)])
    bare, bare_triangles = welded(points, triangles)
    write_ply("gem_little.ply", "binary_little_endian", bare, bare_triangles)


if __name__ == "__main__":
    mi.set_variant("scalar_rgb")
    DATA.mkdir(exist_ok=True)
    write_images()
    write_maps()
    write_environment()
    write_meshes()
