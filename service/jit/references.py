"""Pass named tuples with many members to kernels by reference: as one pointer.

numba passes each member of a tuple as a value of its own, and an array as five and more. A call
with a tuple of a hundred arrays then copies some seven hundred values, unless LLVM inlines it, and
takes long to compile. Members of a tuple do not change while a kernel runs, so LLVM may read each
once.
"""

from typing import Any, TypeVar

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.imputils import impl_ret_borrowed, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate
from numba.core.typing.typeof import typeof_impl
from numba.extending import NativeValue, infer_getattr, register_model, unbox

T = TypeVar("T", bound="type[tuple[Any, ...]]")
_Type: Any = types.Type  # these have no types
_Model: Any = models.PrimitiveModel
_Template: Any = AttributeTemplate
_lowered: Any = lower_getattr_generic
_tuple_of: Any = types.BaseTuple.from_types


class Reference(_Type):  # type: ignore[misc]
    """The type of a pointer to the members of a named tuple."""

    def __init__(self, members: Any) -> None:
        super().__init__(f"reference({members.name})")
        self.members = members


def by_reference(named_tuple: T) -> T:
    """Let kernels take a named tuple by reference; they can read its members, and no more."""

    @typeof_impl.register(named_tuple)
    def type_of(value: Any, context: Any) -> Reference:
        return Reference(_tuple_of([typeof_impl(each, context) for each in value], type(value)))

    return named_tuple


@register_model(Reference)
class _ReferenceModel(_Model):  # type: ignore[misc]
    def __init__(self, manager: Any, reference: Reference) -> None:
        members = manager.lookup(reference.members).get_data_type()
        super().__init__(manager, reference, members.as_pointer())


@infer_getattr
class _Members(_Template):  # type: ignore[misc]
    key = Reference

    def generic_resolve(self, reference: Reference, name: str) -> Any:
        """Return the type of a member; None if there is no such member."""
        names = reference.members.fields
        return reference.members.types[names.index(name)] if name in names else None


@_lowered(Reference)  # type: ignore[untyped-decorator]
def _member(context: Any, builder: Any, reference: Reference, pointer: Any, name: str) -> Any:
    """Return a member."""
    index = reference.members.fields.index(name)
    member = reference.members.types[index]
    data = _read(builder, cgutils.gep_inbounds(builder, pointer, 0, index))
    value = context.data_model_manager[member].from_data(builder, data)
    return impl_ret_borrowed(context, builder, member, value)


def _read(builder: Any, pointer: Any) -> Any:
    """Return what is at a pointer, and tell LLVM of each number of it that it does not change."""
    kind = pointer.type.pointee
    if not isinstance(kind, ir.Aggregate):
        number = builder.load(pointer)
        number.set_metadata("invariant.load", builder.module.add_metadata([]))
        return number
    whole = ir.Constant(kind, ir.Undefined)
    for index in range(
        len(kind.elements) if isinstance(kind, ir.LiteralStructType) else kind.count
    ):
        part = _read(builder, cgutils.gep_inbounds(builder, pointer, 0, index))
        whole = builder.insert_value(whole, part, index)
    return whole


@unbox(Reference)  # type: ignore[untyped-decorator]
def _unbox(reference: Reference, given: Any, c: Any) -> NativeValue:
    """Write the members of a tuple to memory that lasts as long as the call."""
    native = c.unbox(reference.members, given)
    model = c.context.data_model_manager[reference.members]
    place = cgutils.alloca_once(c.builder, model.get_data_type())
    c.builder.store(model.as_data(c.builder, native.value), place)
    pointer = _unknown(c.builder, place)
    return NativeValue(pointer, is_error=native.is_error, cleanup=native.cleanup)


def _unknown(builder: Any, pointer: Any) -> Any:
    """Return a pointer of which LLVM does not know what was written there, or by whom.

    Otherwise it could read members before they are written, since they never change.
    """
    kind = ir.FunctionType(pointer.type, [pointer.type])
    return builder.asm(kind, "", "=r,0,~{memory}", [pointer], side_effect=True)
