"""The members that the rest of a way has beyond those of a new request: the earlier tours."""

from base64 import b64encode
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Base64Bytes, BaseModel, Field

from service.instance import RouteEnds
from service.replanning.earlier_tours import EarlierTours
from service.requests.validation import invalid

# Without AsInteger: these are the service's own, and a hundred thousand of them take a while.
Index = Annotated[int, Field(ge=0, le=2**31 - 1)]
_STOP = np.dtype("<i4")  # of a tour in base64: parsing numbers in JSON takes four times as long


class EncodedTours(BaseModel):
    """Tours of equally many stops."""

    count: int = Field(ge=1)
    stops: Base64Bytes = Field(description="of one tour after another, four bytes each")

    @classmethod
    def members(cls, tours: NDArray[np.int64]) -> dict[str, Any]:
        """Return tours, shape (count, k), as JSON."""
        return {"count": len(tours), "stops": b64encode(tours.astype(_STOP).tobytes()).decode()}

    def tours(self) -> NDArray[np.int64]:
        """Return the tours, shape (count, k).

        Raises:
            Refusal: They differ in length.
        """
        if len(self.stops) % (self.count * _STOP.itemsize):
            raise invalid("earlier_tours", "must be of one length")
        stops = np.frombuffer(self.stops, _STOP).astype(np.int64)
        return stops.reshape(self.count, -1)


class EarlierMembers(BaseModel):
    """What is left of the tours of an earlier front, as the service writes it."""

    earlier_tours: EncodedTours = Field(
        description="what is left of each tour, first of the one being driven"
    )
    min_kept: float = Field(default=0.0, ge=0, le=1, allow_inf_nan=False)
    balance: float | None = Field(
        default=None, ge=0, le=1, description="of the tour being driven, in the earlier front"
    )
    touched: Annotated[list[Index], Field(fail_fast=True)] | None = Field(
        default=None, description="the stops at which these may have become worse; null is any"
    )

    @staticmethod
    def members(earlier: EarlierTours) -> dict[str, Any]:
        """Return the members of these earlier tours, as `earlier_of` reads them."""
        return {
            "earlier_tours": EncodedTours.members(earlier.tours),
            "touched": None if earlier.touched is None else earlier.touched.tolist(),
            "balance": earlier.balance,
            "min_kept": earlier.min_kept,
        }

    def earlier_of(self, n: int, ends: RouteEnds) -> EarlierTours:
        """Return what is left of the earlier tours, of n stops between these ends.

        Raises:
            Refusal: They are not tours of the same stops between the ends.
        """
        tours = self.earlier_tours.tours()
        if not _are_tours(tours, n, ends):
            raise invalid("earlier_tours", "must be of the same stops, between the ends")
        if self.touched is None:
            return EarlierTours(tours, self.min_kept, balance=self.balance)
        if max(self.touched, default=0) >= n:
            raise invalid("touched", "must be of stops that there are")
        touched = np.array(self.touched, np.int64)
        return EarlierTours(tours, self.min_kept, touched, self.balance)


def _are_tours(tours: NDArray[np.int64], n: int, ends: RouteEnds) -> bool:
    if tours.shape[1] == 0:
        return True
    order = np.sort(tours, axis=1)
    places = ((ends.start, 0), (ends.end, -1))
    return bool(
        (order == order[0]).all()
        and (np.diff(order[0]) > 0).all()
        and order[0, 0] >= 0
        and order[0, -1] < n
        and all(end is None or (tours[:, place] == end).all() for end, place in places)
    )
