"""Sign webhooks by HMAC-SHA256, following the specification Standard Webhooks 1.0.0.

The signed text is `{id}.{timestamp}.{body}`. Each secret gives one signature. So an operator can
replace a secret: until all receivers know the new one, events are signed with both.
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
    """A key that signs webhooks. Neither errors nor its representation show its bytes."""

    key: bytes = field(repr=False)

    @classmethod
    def read(cls, text: str) -> Self:
        """Return the secret of a text: whsec_, then 24 to 64 bytes in base64.

        Raises:
            ValueError: The text has another form, or too few or too many bytes.
        """
        try:
            key = base64.b64decode(text.removeprefix(_PREFIX), validate=True)
        except (binascii.Error, ValueError):
            key = b""
        if not (text.startswith(_PREFIX) and _LEAST <= len(key) <= _MOST):
            raise ValueError(f"a secret must be whsec_ and {_LEAST} to {_MOST} bytes in base64")
        return cls(key)


def signed_headers(id: str, seconds: int, body: bytes, secrets: Iterable[Secret]) -> dict[str, str]:
    """Return the headers with the id, the time and the signatures of one attempt.

    Args:
        id: The id of the event, without a full stop; the same in all attempts.
        seconds: The time of the attempt, in seconds since 1970.
        body: The body, byte for byte as it is posted.
        secrets: The secrets; each gives one signature.
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
