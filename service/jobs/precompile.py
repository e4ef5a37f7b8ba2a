"""`python -m service.jobs.precompile`: compile all code into the package, before it is shipped.

For a wheel or an image: processes of such a Python and such a processor load it from there, and
the released networks with it.
"""

from importlib import import_module

from service import jit
from service.actor_info import RELEASED


def main() -> None:
    """Compile what requests need, unless the package already has it."""
    jit.PRECOMPILED.mkdir(parents=True, exist_ok=True)
    # Only now: a function looks for the folder when it is imported.
    import_module("service.jobs.compiled_code").warm_up()
    actors = import_module("service.actor").load_actors(RELEASED, threads=1)
    for actor in actors.values():
        actor.load()


if __name__ == "__main__":
    main()
