#!/usr/bin/env python3
"""Writes the first corpus of the glTF fuzz targets: small files of our own, one for each thing a reader branches on.

usage: tests/fuzz/seeds.py FOLDER
"""
import base64
import json
import pathlib
import struct
import sys
import zlib

FLOAT, BYTE, UBYTE, SHORT, USHORT, UINT = 5126, 5120, 5121, 5122, 5123, 5125
CODES = {FLOAT: "f", BYTE: "b", UBYTE: "B", SHORT: "h", USHORT: "H", UINT: "I"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
TRIANGLE = [0, 0, 0, 1, 0, 0, 0, 1, 0]


class File:
    """A glTF document under construction, with one buffer."""

    def __init__(self, **members):
        self.document = {"asset": {"version": "2.0"}, **members}
        self.binary = b""

    def add(self, collection, **member):
        items = self.document.setdefault(collection, [])
        items.append(member)
        return len(items) - 1

    def view(self, data, **more):
        self.binary += b"\0" * (-len(self.binary) % 4)
        offset = len(self.binary)
        self.binary += data
        return self.add("bufferViews", buffer=0, byteOffset=offset, byteLength=len(data), **more)

    def accessor(self, values, kind="VEC3", component=FLOAT, stride=0, **more):
        width = WIDTHS[kind]
        elements = [struct.pack(f"<{width}{CODES[component]}", *values[i:i + width])
                    for i in range(0, len(values), width)]
        strided = {"byteStride": stride} if stride else {}
        data = b"".join(e.ljust(stride, b"\0") for e in elements)
        return self.add("accessors", bufferView=self.view(data, **strided), componentType=component, type=kind,
                        count=len(elements), **more)

    def mesh(self, attributes, node=None, weights=None, **primitive):
        more = {"weights": weights} if weights else {}
        mesh = self.add("meshes", primitives=[{"attributes": attributes, **primitive}], **more)
        return self.add("nodes", mesh=mesh, **(node or {}))

    def text(self):
        if self.binary:
            self.document["buffers"] = [{"byteLength": len(self.binary)}]
        return json.dumps(self.document, separators=(",", ":")).encode()

    def gltf(self):
        self.text()
        if self.binary:
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
            self.document["buffers"][0]["uri"] = uri
        return json.dumps(self.document, separators=(",", ":")).encode()

    def glb(self):
        text = self.text()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        if self.binary:
            binary = self.binary + b"\0" * (-len(self.binary) % 4)
            chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def triangle(**members):
    file = File(**members)
    file.mesh({"POSITION": file.accessor(TRIANGLE)})
    return file


def png(width=2, height=2, depth=8, kind=2):
    samples = {0: 1, 2: 3, 4: 2, 6: 4}[kind] * depth // 8
    rows = b"".join(b"\0" + bytes((x * 7 + y) % 256 for x in range(width * samples)) for y in range(height))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def textured(data, texture=None, slot=None, **members):
    file = File(**members)
    file.add("images", bufferView=file.view(data), mimeType="image/png")
    file.add("samplers", wrapS=33071, wrapT=33648, minFilter=9987, magFilter=9728)
    file.add("textures", **(texture or {"source": 0, "sampler": 0}))
    file.add("materials", **(slot or {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}))
    file.mesh({"POSITION": file.accessor(TRIANGLE), "TEXCOORD_0": file.accessor([0, 0, 1, 0, 0, 1], "VEC2"),
               "NORMAL": file.accessor([0, 0, 1] * 3)}, material=0)
    return file


def sparse(based):
    file = File()
    indices = file.view(bytes([0, 2]))
    values = file.view(struct.pack("<6f", 1, 1, 1, 2, 2, 2))
    part = {"count": 2, "indices": {"bufferView": indices, "componentType": UBYTE}, "values": {"bufferView": values}}
    if based:
        at = file.accessor(TRIANGLE, sparse=part)
    else:
        at = file.add("accessors", componentType=FLOAT, type="VEC3", count=3, sparse=part)
    file.mesh({"POSITION": at})
    return file


def skinned():
    file = triangle()
    accessors = {"POSITION": 0, "JOINTS_0": file.accessor([0, 1, 0, 0] * 3, "VEC4", UBYTE),
                 "WEIGHTS_0": file.accessor([0.5, 0.5, 0, 0] * 3, "VEC4")}
    file.document["meshes"][0]["primitives"][0]["attributes"] = accessors
    identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    file.document["nodes"] = [{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [0, 1, 0]}]
    file.add("skins", joints=[1, 2], skeleton=1, inverseBindMatrices=file.accessor(identity * 2, "MAT4"))
    return file


def animated(path, values, kind, interpolation):
    file = triangle()
    file.add("animations", name="a",
             samplers=[{"input": file.accessor([0, 1], "SCALAR", min=[0], max=[1]),
                        "output": file.accessor(values, kind), "interpolation": interpolation}],
             channels=[{"sampler": 0, "target": {"node": 0, "path": path}}])
    return file


def compressed():
    """Extensions whose payloads have headers of their own: their documents, with payloads that are short or zero."""
    draco = File(extensionsUsed=["KHR_draco_mesh_compression"])
    draco.add("accessors", componentType=FLOAT, type="VEC3", count=3)
    draco.add("accessors", componentType=USHORT, type="SCALAR", count=3)
    payload = b"DRACO\x02\x02\x01\x00\x00\x00" + b"\x03\x01" + bytes(16)
    extension = {"bufferView": draco.view(payload), "attributes": {"POSITION": 0}}
    draco.mesh({"POSITION": 0}, indices=1, extensions={"KHR_draco_mesh_compression": extension})
    yield "draco", draco
    for name in ("EXT_meshopt_compression", "KHR_meshopt_compression"):
        for mode, stride, head in (("ATTRIBUTES", 12, b"\xa0"), ("TRIANGLES", 2, b"\xe1"), ("INDICES", 2, b"\xd1")):
            file = File(extensionsUsed=[name])
            data = file.view(head + bytes(40))
            extension = {"buffer": 0, "byteOffset": 0, "byteLength": 41, "byteStride": stride, "count": 3, "mode": mode}
            if mode == "ATTRIBUTES":
                extension["filter"] = "NONE"
            file.document["bufferViews"][data].update(byteLength=3 * stride, extensions={name: extension})
            file.add("accessors", bufferView=0, componentType=FLOAT if stride == 12 else USHORT,
                     type="VEC3" if stride == 12 else "SCALAR", count=3)
            yield f"{name[:3].lower()}-meshopt-{mode.lower()}", file


def seeds():
    yield "empty", File()
    yield "triangle", triangle(scene=0, scenes=[{"nodes": [0], "name": "s"}])
    file = File()
    file.mesh({"POSITION": file.accessor(TRIANGLE, stride=16), "NORMAL": file.accessor([0, 0, 127] * 3, "VEC3", BYTE,
              4, normalized=True), "TEXCOORD_0": file.accessor([0, 0, 255, 0, 0, 255], "VEC2", UBYTE, 4,
              normalized=True), "COLOR_0": file.accessor([65535, 0, 0, 1] * 3, "VEC4", USHORT, normalized=True),
              "TANGENT": file.accessor([1, 0, 0, 1] * 3, "VEC4")})
    yield "attributes", file
    for component in (UBYTE, USHORT, UINT):
        for mode in (4, 5, 6):
            file = File()
            file.mesh({"POSITION": file.accessor([*TRIANGLE, 1, 1, 0])},
                      indices=file.accessor([0, 1, 2, 1, 3, 2], "SCALAR", component), mode=mode)
            yield f"indices-{component}-{mode}", file
    for mode in (0, 1, 2, 3):
        file = triangle()
        file.document["meshes"][0]["primitives"][0]["mode"] = mode
        yield f"mode-{mode}", file
    yield "sparse-based", sparse(True)
    yield "sparse-alone", sparse(False)
    file = triangle()
    file.document["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": file.accessor([0, 0, 1] * 3)}]
    file.document["meshes"][0]["weights"] = [0.5]
    yield "morph", file
    yield "skin", skinned()
    yield "animation-translation", animated("translation", [0, 0, 0, 1, 1, 1], "VEC3", "LINEAR")
    yield "animation-rotation", animated("rotation", [0, 0, 0, 1] * 6, "VEC4", "CUBICSPLINE")
    yield "animation-scale", animated("scale", [1, 1, 1, 2, 2, 2], "VEC3", "STEP")
    yield "cameras", File(
        cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "zfar": 9, "aspectRatio": 2}},
                 {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 2}}],
        nodes=[{"camera": 0, "rotation": [0, 0, 0, 1]}, {"camera": 1, "children": [0]}], scenes=[{"nodes": [1]}])
    lights = [{"type": "directional", "intensity": 3}, {"type": "point", "color": [1, 0, 0], "range": 4},
              {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}]
    yield "lights", File(extensionsUsed=["KHR_lights_punctual"],
                         extensions={"KHR_lights_punctual": {"lights": lights}},
                         nodes=[{"extensions": {"KHR_lights_punctual": {"light": i}}} for i in range(3)])
    yield "transforms", File(nodes=[{"matrix": [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1], "children": [1, 2]},
                                    {"translation": [1, 2, 3], "rotation": [0, 1, 0, 0], "scale": [1, -1, 2]},
                                    {"extensions": {"KHR_node_visibility": {"visible": False}}}],
                             extensionsUsed=["KHR_node_visibility"])
    for depth, kind in ((8, 0), (8, 2), (8, 4), (8, 6), (16, 2), (16, 6)):
        yield f"png-{depth}-{kind}", textured(png(depth=depth, kind=kind))
    transform = {"KHR_texture_transform": {"offset": [0, 1], "rotation": 1, "scale": [2, 2], "texCoord": 0}}
    yield "material", textured(png(), slot={
        "name": "m", "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": True, "emissiveFactor": [1, 0.5, 0],
        "normalTexture": {"index": 0, "scale": 0.5}, "occlusionTexture": {"index": 0, "strength": 0.5},
        "emissiveTexture": {"index": 0}, "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}},
        "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "metallicFactor": 0.5, "roughnessFactor": 0.25,
                                 "metallicRoughnessTexture": {"index": 0, "extensions": transform}}},
        extensionsUsed=["KHR_texture_transform", "KHR_materials_emissive_strength"])
    yield "unlit", textured(png(), slot={"alphaMode": "BLEND", "extensions": {"KHR_materials_unlit": {}}},
                            extensionsUsed=["KHR_materials_unlit"])
    yield "webp", textured(base64.b64decode("UklGRhwAAABXRUJQVlA4TBAAAAAvAUAAAAcQEf0PRET/Aw=="),
                           texture={"extensions": {"EXT_texture_webp": {"source": 0}}},
                           extensionsUsed=["EXT_texture_webp"], extensionsRequired=["EXT_texture_webp"])
    uri = "data:image/png;base64," + base64.b64encode(png()).decode()
    yield "image-uri", File(images=[{"uri": uri, "name": "i"}], textures=[{"source": 0}],
                            materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])
    file = triangle(extensionsUsed=["EXT_mesh_gpu_instancing"])
    attributes = {"TRANSLATION": file.accessor([0, 0, 0, 2, 0, 0]),
                  "ROTATION": file.accessor([0, 0, 0, 127] * 2, "VEC4", BYTE, normalized=True),
                  "SCALE": file.accessor([1, 1, 1, 2, 2, 2])}
    file.document["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    yield "instancing", file
    yield "variants", File(extensionsUsed=["KHR_materials_variants"],
                           extensions={"KHR_materials_variants": {"variants": [{"name": "v"}, {}]}})
    yield "extras", File(nodes=[{"extras": {"etalon": {"sphere": {"radius": 1, "material": 0}}}, "camera": 0}],
                         materials=[{"extras": {"etalon": {"one_sided": True}}}],
                         cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 1},
                                   "extras": {"etalon": {"thin_lens": {"radius": 0.1, "focus": 2}}}}],
                         scenes=[{"nodes": [0], "extras": {"etalon": {"size": [8, 8]}}}])
    yield "zero-filled", File(accessors=[{"componentType": FLOAT, "type": "MAT3", "count": 3},
                                         {"componentType": BYTE, "type": "MAT2", "count": 3},
                                         {"componentType": SHORT, "type": "MAT3", "count": 1},
                                         {"componentType": BYTE, "type": "MAT4", "count": 1}])
    yield "escapes", File(buffers=[{"byteLength": 3, "uri": "data:,a%20b"}],
                          extras={"a/b~c": [None, True, -1, 1.5e-3, "\u20ac", {}]})
    yield from compressed()


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, file in seeds():
        (folder / f"{name}.glb").write_bytes(file.glb())
        (folder / f"{name}.gltf").write_bytes(file.gltf())
    for name, text in (("version-1", b'{"asset":{"version":"1.0"}}'), ("no-object", b"[1]"), ("no-json", b"BZh9"),
                       ("mark", b'\xef\xbb\xbf{"asset":{"version":"2.0"}}')):
        (folder / f"{name}.gltf").write_bytes(text)


if __name__ == "__main__":
    main()
