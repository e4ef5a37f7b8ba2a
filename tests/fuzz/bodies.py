"""Bodies that no honest client sends, from a seed: broken files, JSON, parts, and extreme numbers.

Each generator takes a number generator and returns the source of one request.
"""

import io
import json
import random
import struct
import zlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from PIL import Image

from service.errors import Refusal
from service.requests.multipart import split_parts
from service.requests.replan.way import ReplanSource
from service.requests.task import TaskSource
from tests.fuzz.fleets import fleet
from tests.fuzz.mutations import EXTREMES, TOKENS, mutated
from tests.fuzz.replans import replan

Generator = Callable[[random.Random], TaskSource]

_OPTIONS: dict[str, Any] = {"time_limit": 0, "preferences": 3}
_SPACING = {**_OPTIONS, "cell_size": 1, "spacing": 2, "second_coordinates": [[0, 1]]}
_POSE = {"position": {"x": 0, "y": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
_BY_MESSAGE = {
    **{name: value for name, value in _SPACING.items() if name != "cell_size"},
    "occupancy_grid": {
        "info": {"resolution": 1, "width": 3, "height": 2, "origin": _POSE},
        "data": [0, 100, -1, 0, 0, 50],
    },
}
_HEADERS = [
    *(
        b"'",
        b"''",
        b"(",
        b")",
        b"{",
        b"}",
        b"[",
        b":",
        b",",
        b"\\",
        b"\n",
        b"\t",
        b"#",
        b"0x",
        b"L",
    ),
    *(b"-1", b"1e9", b"9" * 30, b"0x" + b"f" * 4000, b"(" * 300, b"-" * 3000, b"None", b"True"),
    *(b"'<f8'", b"'|O'", b"'f'", b"'<f16'", b"'shape'", b"**", b"\x00", b"\xff", b"  " * 2000),
]
_CHUNKS = (b"IHDR", b"PLTE", b"IDAT", b"IEND", b"tRNS", b"iCCP", b"zTXt", b"acTL", b"fdAT", b"eXIf")


def npy(rng: random.Random) -> TaskSource:
    """Return matrices in a .npy file with some bytes of its header, or beside it, mutated."""
    n = rng.randint(1, 6)
    stream = io.BytesIO()
    kind = rng.choice(["<f8", ">f8", "<f4", "<f2", "<i4", "<u2", "|b1", "<c16"])
    np.save(stream, np.full((2, n, n), rng.randint(0, 3)).astype(kind))
    content = mutated(rng, stream.getvalue(), _HEADERS, 120)
    return TaskSource("front", json.dumps(_OPTIONS).encode(), content)


def png(rng: random.Random) -> TaskSource:
    """Return a map in a PNG file with chunks added, repeated, left out or mutated."""
    stream = io.BytesIO()
    size = rng.randint(1, 20), rng.randint(1, 20)
    Image.new(rng.choice(["1", "L", "LA", "P", "RGB", "RGBA", "I;16"]), size).save(stream, "PNG")
    content = stream.getvalue()
    for _ in range(rng.randint(0, 2)):
        sizes = (0, 1, 8, 13_300, 2**31 - 1, 2**32 - 1)
        header = struct.pack(">II", rng.choice(sizes), rng.choice(sizes)) + b"\x08\0\0\0\0"
        packed = zlib.compress(bytes(rng.choice((1, 1000, 2_000_000))))
        inside = rng.choice([header, packed, b"", b"x\0\0" + packed, rng.randbytes(20)])
        at = rng.choice([8, 33, len(content) - 12])
        content = content[:at] + _chunk(rng.choice(_CHUNKS), inside) + content[at:]
    if rng.random() < 0.6:
        content = mutated(rng, content, [b"", b"\0", b"\xff", b"IHDR", b"\0\0\0\r"], len(content))
    return TaskSource("coverage", json.dumps(_SPACING).encode(), content)


def pgm(rng: random.Random) -> TaskSource:
    """Return a map in a PGM file with its header or its shades mutated, and any reading of it."""
    columns, rows = rng.randint(1, 20), rng.randint(1, 20)
    white = rng.choice([1, 255, 255])
    shades = [rng.choice((0, white)) for _ in range(rows * columns)]
    plain = rng.random() < 0.5
    raster = " ".join(map(str, shades)).encode() if plain else bytes(shades)
    content = b"P%d\n# map\n%d %d\n%d\n" % (2 if plain else 5, columns, rows, white) + raster
    tokens = [b"#", b"\n", b"\r", b" " * 5000, b"-1", b"0", b"65536", b"9" * 5000, b"\xff", b"P5"]
    members = {
        "mode": rng.choice(["trinary", "scale", "raw"]),
        "negate": rng.random() < 0.5,
        "occupied_thresh": rng.choice([0, 0.65, 1]),
        "free_thresh": rng.choice([0, 0.196, 1]),
        "unknown": rng.choice(["blocked", "free"]),
        "origin": [rng.choice(EXTREMES), -rng.choice(EXTREMES), rng.choice(EXTREMES)],
        "start_pose": [rng.choice(EXTREMES), 0],
    }
    request = {**_SPACING, **dict(rng.sample(sorted(members.items()), rng.randint(0, 5)))}
    return TaskSource(
        "coverage", json.dumps(request).encode(), mutated(rng, content, tokens, len(content))
    )


def json_body(rng: random.Random) -> TaskSource:
    """Return JSON of a request with tokens put in, members repeated, or cut short."""
    rows = [[rng.choice((0, 1, 2.5)) for _ in range(4)] for _ in range(rng.randint(1, 6))]
    requests: list[tuple[Any, dict[str, Any]]] = [
        ("front", {"coordinates": rows}),
        ("front", {"matrices": [[[0, 1], [1, 0]]] * 2}),
        ("coverage", {**_SPACING, "grid": [[0, 0, 1]] * 3}),
        ("coverage", {**_SPACING, "grid": [[0, 0]] * 2, "cost_layer": [[1, 2]] * 2}),
        ("coverage", {**_BY_MESSAGE, "start_pose": [0.5, 0.5]}),
    ]
    kind, request = rng.choice(requests)
    options = {"seed": 1, "start": 0, "reference_point": [9, 9], "initial_tours": [[0, 1]]}
    request = {**_OPTIONS, **request, **dict(rng.sample(sorted(options.items()), 2))}
    body = json.dumps(request).encode()
    return TaskSource(kind, mutated(rng, body, TOKENS, len(body)))


def robots(rng: random.Random) -> TaskSource:
    """Return JSON of a request for robots with any starts and ends, some of it mutated."""

    def number() -> float:
        return rng.choice(EXTREMES) if rng.random() < 0.02 else rng.randint(0, 3)

    def robot(index: int) -> dict[str, Any]:
        members = {
            "start": number(),
            "end": number(),
            "start_pose": [number() for _ in range(rng.choice([1, 2, 2, 2, 3, 4]))],
            "end_pose": [number(), number()],
        }
        chosen = rng.sample(sorted(members), rng.randint(0, 2))
        return {"id": f"robot {index % 50}", **{name: members[name] for name in chosen}}

    request = {
        "grid": [[0, 0, 0], [rng.randint(0, 1), 0, 0]],
        "cell_size": rng.choice([1, 1, 1, 0.5, 1e150, 1e-150]),
        "origin": [0, 0, number()],
        "places": [[0, 0], [0, 1], [0, 2], [1, 2]][: rng.randint(1, 4)],
        "robots": [robot(index) for index in range(rng.choice([1, 2, 3, 3, 60]))],
        "over": [rng.choice(["sum", "max"]), rng.choice(["sum", "max"])],
        "closed": rng.random() < 0.5,
        "paths": True,
        "time_limit": 0,
    }
    body = json.dumps(request).encode()
    return TaskSource("coverage", mutated(rng, body, TOKENS, len(body)))


def multipart(rng: random.Random) -> TaskSource | Refusal:
    """Return what a mutated multipart body splits into, or its refusal."""
    kind: Any = rng.choice(["front", "coverage"])
    upload = "matrices" if kind == "front" else "map"
    source = npy(rng) if kind == "front" else png(rng)
    part = b'--x\r\nContent-Disposition: form-data; name="%s"\r\n\r\n%s\r\n'
    body = part % (b"request", source.body) + part % (upload.encode(), source.upload or b"")
    tokens = [b"--x", b"\r\n", b"--", b"\r\n--x\r\n", b"--x--", b'name="', b" " * 5000, b";" * 99]
    body = mutated(rng, body + b"--x--\r\n", tokens, 200)
    types = ("x", "x", "x", '"x"', "", "x" * 80, "é", '"x')
    try:
        parts = split_parts(
            f"multipart/form-data; boundary={rng.choice(types)}", body, ("request", upload)
        )
    except Refusal as refusal:
        return refusal
    return TaskSource(kind, parts["request"], parts[upload])


def day(rng: random.Random) -> TaskSource:
    """Return a request over the day, of any times, factors and slices, some of it mutated."""
    n = rng.randint(1, 6)

    def number(most: float = 90_000) -> float:
        return rng.choice(EXTREMES) if rng.random() < 0.02 else rng.randint(0, int(most))

    def matrix() -> list[list[float | None]]:
        empty = rng.random() < 0.2
        return [[None if empty and i < j else number(99) for j in range(n)] for i in range(n)]

    def objective(name: str) -> dict[str, Any]:
        times = sorted(number() for _ in range(rng.randint(1, 4)))
        if rng.random() < 0.4:
            return {"name": name, "slices": [{"from": t, "matrix": matrix()} for t in times]}
        if rng.random() < 0.4:
            pairs = [[[[time, number(99)] for time in times] for _ in range(n)] for _ in range(n)]
            return {"name": name, "breakpoints": pairs}
        factors = [[time, rng.choice([0.01, 0.5, 1, 2, 100, number(3)])] for time in times]
        return {"name": name, "matrix": matrix(), "over_the_day": factors}

    request = {
        "stops": [{"id": f"{i}", "service": number(900)} for i in range(n)],
        "objectives": [objective(name) for name in "abcd"[: rng.choice([2, 2, 3])]],
        "departure": rng.choice([number(), {"earliest": number(1000), "latest": number()}]),
        "closed": rng.random() < 0.5,
        "time_limit": rng.choice([0, 0.02]),
    }
    if rng.random() < 0.3:
        request["clock"] = rng.choice(["a", "b", "x"])
    body = json.dumps(request).encode()
    return TaskSource("front", mutated(rng, body, TOKENS, len(body)))


def extreme(rng: random.Random) -> TaskSource:
    """Return a request of numbers from 5e-324 to 1e308, of all scales or of one."""
    n = rng.randint(1, 9)
    scales = rng.choice([EXTREMES, (0.0,), (rng.choice(EXTREMES),)])

    def numbers(count: int) -> list[float]:
        return [rng.choice(scales) * rng.choice((1, rng.random())) for _ in range(count)]

    request: dict[str, Any] = {"time_limit": rng.choice([0, 0.02]), "preferences": 5}
    if rng.random() < 0.5:
        request["coordinates"] = [numbers(4) for _ in range(n)]
    else:
        request["matrices"] = [[numbers(n) for _ in range(n)] for _ in range(2)]
    if rng.random() < 0.3:
        request["reference_point"] = numbers(2)
    return TaskSource("front", json.dumps(request).encode())


GENERATORS: Mapping[str, Callable[[random.Random], TaskSource | ReplanSource | Refusal]] = {
    "npy": npy,
    "png": png,
    "pgm": pgm,
    "json": json_body,
    "robots": robots,
    "fleet": fleet,
    "day": day,
    "multipart": multipart,
    "replan": replan,
}


def _chunk(kind: bytes, content: bytes) -> bytes:
    checksum = zlib.crc32(kind + content)
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)
