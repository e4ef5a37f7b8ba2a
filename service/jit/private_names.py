"""The names that `kernels` needs of numba and that numba does not document."""

from importlib import import_module
from operator import attrgetter

_NAMES = {
    "numba.core.bytecode": ("FunctionIdentity.from_function", "FunctionIdentity._unique_ids"),
    "numba.core.caching": (
        *("CacheImpl._locator_classes", "InTreeCacheLocator.from_function"),
        *("FunctionCache._load_overload", "FunctionCache._guard_against_spurious_io_errors"),
        *("IndexDataCacheFile._load_index", "IndexDataCacheFile._save_index"),
        *("IndexDataCacheFile._save_data", "IndexDataCacheFile._data_name"),
    ),
    "numba.core.codegen": (
        *("JITCPUCodegen._library_class", "JITCPUCodegen.set_env"),
        *("JITCPUCodegen._function_pass_manager", "JITCodeLibrary._finalize_final_module"),
        *("JITCodeLibrary._get_module_for_linking", "JITCodeLibrary._optimize_functions"),
        *("JITCodeLibrary._get_compiled_object", "JITCodeLibrary._set_compiled_object"),
        *("JITCodeLibrary._unserialize", "JITCodeLibrary.serialize_using_object_code"),
    ),
    "numba.core.compiler": ("Flags.options",),
    "numba.core.dispatcher": (
        *("Dispatcher._compile_for_args", "Dispatcher._insert", "Dispatcher.add_overload"),
        *("Dispatcher.get_call_template", "Dispatcher.get_overload"),
        *("_FunctionCompiler._compile_core", "_FunctionCompiler.compile"),
    ),
    "numba.core.environment": ("Environment._memo", "_rebuild_env", "lookup_environment"),
    "numba.core.runtime.nrt": ("rtsys.initialize",),
    "numba.core.target_extension": ("get_local_target",),
    "numba.core.targetconfig": ("ConfigStack.top_or_none",),
    "numba.core.types.functions": ("BaseFunction.get_call_type", "BaseFunction.get_impl_key"),
    "numba.np.arrayobj": ("fix_integer_index",),
}


def missing_name() -> str | None:
    """Return the first name that the installed numba lacks; None if it has all."""
    for module, names in _NAMES.items():
        for name in names:
            try:
                attrgetter(name)(import_module(module))
            except (ImportError, AttributeError):
                return f"{module}.{name}"
    return None
