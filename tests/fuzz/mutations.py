"""Mutations of bodies: tokens put in, bytes left out; and numbers that are hard to compute with."""

import random

TOKENS = [
    *(b"null", b"true", b'""', b'"\\ud800"', b"[]", b"[[]]", b"{}", b"-0.0", b"-1", b"1e308"),
    *(b"1e309", b"5e-324", b"NaN", b"-Infinity", b"9" * 400, b"9" * 5000, b"[" * 300, b"{" * 300),
    *(
        b"[0," * 3,
        b'"x":',
        b",",
        b":",
        b"]",
        b"}",
        b"\x00",
        b"\xff",
        b'"' * 3,
        b"1.5",
        b"2147483648",
    ),
]
EXTREMES = (
    0.0,
    5e-324,
    1e-310,
    1e-300,
    1e-160,
    1e-150,
    1e-8,
    1.0,
    1e8,
    1e149,
    1e150,
    1e151,
    1e308,
)


def mutated(rng: random.Random, content: bytes, tokens: list[bytes], within: int) -> bytes:
    """Return the content with up to four changes in its first bytes, and sometimes cut short."""
    for _ in range(rng.randint(0, 4)):
        at = rng.randrange(min(within, len(content)) + 1)
        removed = rng.choice((0, 0, 1, 1, 2, 10))
        put = rng.choice([rng.choice(tokens), rng.choice(tokens), rng.randbytes(1)])
        content = content[:at] + put + content[at + removed :]
    return content[: rng.randrange(len(content) + 1)] if rng.random() < 0.15 else content
