"""The client under its old name, for one more release. Import `paretour` instead."""

import warnings

from paretour import *  # noqa: F403
from paretour import __all__ as __all__

warnings.warn(
    "service.client is now called paretour: from paretour import Client",
    DeprecationWarning,
    stacklevel=2,
)
