"""Name callers by the hashes of their API keys.

A key is 256 random bits. The settings hold only its SHA-256, which needs no salt because 256 random
bits cannot be guessed. The settings are read by what has no HTTP side too, so this module is quick
to import.
"""

import hashlib
import re
import secrets
from dataclasses import dataclass
from typing import Self

_NAME = re.compile(r"[A-Za-z0-9._-]{1,64}")


@dataclass(frozen=True, kw_only=True)
class KeyHash:
    """The name of a caller and the SHA-256 of one of its keys, in hexadecimal.

    Errors do not show the values: one may be a key, written in the wrong place.
    """

    caller: str
    digest: str

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.caller):
            raise ValueError("a caller must be named by 1 to 64 letters, digits, dots, dashes")
        if len(self.digest) != 64 or not set(self.digest) <= set("0123456789abcdef"):
            raise ValueError("the hash after CALLER: must be 64 hexadecimal digits")

    @classmethod
    def read(cls, text: str) -> Self:
        """Return the hash written as CALLER:DIGEST."""
        caller, _, digest = text.partition(":")
        return cls(caller=caller, digest=digest)


def new_key() -> tuple[str, str]:
    """Return a new key, which the caller gets, and its hash, which the settings get."""
    key = secrets.token_urlsafe(32)
    return key, digest_of(key)


def digest_of(key: str) -> str:
    """Return the SHA-256 of a key, in hexadecimal."""
    return hashlib.sha256(key.encode()).hexdigest()
