"""How property tests run: never against a clock, and in continuous integration always alike."""

import os

from hypothesis import settings

settings.register_profile("project", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("project")
