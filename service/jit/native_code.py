"""Native code for the functions that Python calls, and for no others.

numba optimises a function together with all that it calls, and generates native code for all of
them. Then it does the same for each function that calls it, up to those that Python calls. So a
function that is called in several steps was optimised as many times, and most of its native code
was for nobody. Here a function that only compiled code calls is merely linked to its callers. It is
optimised as a part of them. A standalone function is not: other functions call its native code.

A library is what numba calls the code of a function for one combination of argument types.
"""

from collections.abc import Iterator
from importlib import import_module
from typing import Any, NamedTuple, TypeAlias

from llvmlite import binding
from numba.core import codegen
from numba.core.environment import lookup_environment

_LINKED, _NATIVE = "linked", "native"  # the two states in which a library is cached
_NumbaLibrary: Any = codegen.JITCodeLibrary  # it has no types
_Codegen: Any = codegen.JITCPUCodegen
_Module: TypeAlias = Any  # llvmlite's, which has no types either


class Standalone(NamedTuple):
    """A standalone function for one combination of argument types."""

    module: str
    name: str
    arguments: tuple[Any, ...]  # numba's types

    def load(self) -> None:
        """Load its native code from the cache, or compile it."""
        getattr(import_module(self.module), self.name).compile(self.arguments)


class _Library(_NumbaLibrary):  # type: ignore[misc]
    """A library that generates native code once the address of a function of it is asked for."""

    standalone: Standalone | None = None  # whose code it is
    linked = True  # whether other libraries may link it

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self._shared_module: _Module = None
        self._bitcode = b""  # of one that was loaded, which is read once another library links it
        self._called: set[Standalone] = set()

    def add_linking_library(self, library: Any) -> None:
        self._linking_libraries.append(library)

    def finalize(self) -> None:
        self._link()
        super().finalize()
        for variable in _defined(self._final_module.global_variables):
            environment = lookup_environment(variable.name)
            if environment is not None:
                self._codegen.set_env(variable.name, environment)

    def get_pointer_to_function(self, name: str) -> int:
        if self._finalized or name in _names(self._final_module.functions):
            return int(super().get_pointer_to_function(name))
        return 0

    @property
    def has_dynamic_globals(self) -> bool:
        self._link()
        variables = self._final_module.global_variables
        return any(each.name.startswith("numba.dynamic.globals") for each in variables)

    def _link(self) -> None:
        """Add the code of the libraries that this one calls, but for standalone functions."""
        libraries = dict.fromkeys(self._linking_libraries)  # in order, and each once
        self._linking_libraries.clear()
        for library in libraries:
            if library.standalone:
                self._called.add(library.standalone)
                continue
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)  # noqa: SLF001  # of the same class
            self._reload_init.update(library._reload_init)  # noqa: SLF001  # as above
            self._called |= library._called  # noqa: SLF001  # as above

    def _optimize_functions(self, module: _Module) -> None:
        """Simplify functions a little: they are optimised as parts of what calls them."""
        module.data_layout = self._codegen._data_layout  # noqa: SLF001  # as numba does
        passes, builder = self._codegen._function_pass_manager(opt=1)  # noqa: SLF001
        for function in _defined(module.functions):
            passes.run(function, builder)

    def _get_module_for_linking(self) -> _Module:
        if self._shared_module is None:
            self._link()
            self._shared_module = (
                binding.parse_bitcode(self._bitcode)
                if self._bitcode
                else _linked_by_many(self._final_module)
            )
        return self._shared_module

    def serialize_using_object_code(self) -> tuple[Any, ...]:
        linked = self.linked and not self.standalone
        bitcode = self._get_module_for_linking().as_bitcode() if linked else b""
        if not self._finalized:
            return self.name, _LINKED, self._called, bitcode
        module = self._final_module
        names = {*_names(module.functions), *_names(module.global_variables)}
        return self.name, _NATIVE, self._called, (bitcode, names, self._get_compiled_object())

    @classmethod
    def _unserialize(cls, generator: Any, state: tuple[Any, ...]) -> "_Library":
        name, kind, called, data = state
        library: _Library = generator.create_library(name)
        library._called = called
        for each in called:
            each.load()
        if kind == _LINKED:
            library._final_module = binding.parse_bitcode(data)
            return library
        library._bitcode, names, native = data
        library.enable_object_caching()
        library._set_compiled_object(native)
        library._finalize_final_module()
        generator._engine._defined_symbols.update(names)  # noqa: SLF001  # it has no setter
        return library


def _defined(values: Any) -> Iterator[Any]:
    """Yield the functions or variables of a module that it does not only declare."""
    return (value for value in values if not value.is_declaration)


def _names(values: Any) -> set[str]:
    return {value.name for value in _defined(values)}


def _linked_by_many(module: _Module) -> _Module:
    """Return a copy of a module that others link, some of them by several ways."""
    shared = module.clone()
    for function in _defined(shared.functions):
        if function.linkage == binding.Linkage.external:
            function.linkage = binding.Linkage.linkonce_odr
    return shared


def _set_env(generator: Any, name: str, environment: object) -> None:
    """Do as numba does, unless no native code needs the environment."""
    if generator._engine.is_symbol_defined(name):  # noqa: SLF001
        _numba_set_env(generator, name, environment)


_numba_set_env = _Codegen.set_env


def generate_late() -> None:
    """Let numba generate native code for what Python calls alone, from here on."""
    _Codegen.set_env = _set_env
    _Codegen._library_class = _Library  # noqa: SLF001  # it has no setter
