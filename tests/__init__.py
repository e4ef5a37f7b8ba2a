"""The tests, whose modules are compiled once for all their processes."""

import sys

# Many processes are started, each of which would compile what none before it kept. This comes
# before `tests.conftest` imports anything: to rewrite the assertions of Hypothesis takes seconds.
sys.dont_write_bytecode = False
