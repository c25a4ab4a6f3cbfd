"""Generated examples are the same in every run of CI; elsewhere they are new ones each time."""

import os

from hypothesis import settings

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("here", deadline=None)  # a busy machine proves nothing against a law
settings.load_profile("ci" if os.environ.get("CI") else "here")
