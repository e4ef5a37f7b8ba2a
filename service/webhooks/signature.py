"""Sign webhooks by HMAC-SHA256, as the specification Standard Webhooks 1.0.0 says.

The text that is signed is `{id}.{timestamp}.{body}`. With several secrets there are as many
signatures, so that a secret can be replaced while receivers still know the former one.
"""

import base64
import binascii
import hashlib
import hmac
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Self

_PREFIX = "whsec_"
_LEAST, _MOST = 24, 64  # bytes of a secret, by the specification


@dataclass(frozen=True)
class Secret:
    """The bytes of a secret, which neither errors nor its representation show."""

    key: bytes = field(repr=False)

    @classmethod
    def read(cls, text: str) -> Self:
        """Return the secret written as whsec_ and base64.

        Raises:
            ValueError: It has another form, or too few or too many bytes.
        """
        try:
            key = base64.b64decode(text.removeprefix(_PREFIX), validate=True)
        except (binascii.Error, ValueError):
            key = b""
        if not (text.startswith(_PREFIX) and _LEAST <= len(key) <= _MOST):
            raise ValueError(f"a secret must be whsec_ and {_LEAST} to {_MOST} bytes in base64")
        return cls(key)


def signed_headers(
    id: str,  # noqa: A002
    seconds: int,
    body: bytes,
    secrets: Iterable[Secret],
) -> dict[str, str]:
    """Return the headers of an attempt to deliver a message.

    Args:
        id: Of the message, without a full stop; the same for all attempts.
        seconds: When the attempt is made, since 1970.
        body: The body as it is sent.
        secrets: What to sign with.
    """
    text = b"%s.%d.%s" % (id.encode(), seconds, body)
    signatures = (
        base64.b64encode(hmac.digest(secret.key, text, hashlib.sha256)).decode()
        for secret in secrets
    )
    return {
        "webhook-id": id,
        "webhook-timestamp": str(seconds),
        "webhook-signature": " ".join(f"v1,{signature}" for signature in signatures),
    }
