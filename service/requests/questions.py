"""The query of `GET /front/{id}/questions`, and the question about a front that it asks for."""

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from paretour.choice import WrongChoice
from paretour.described import document_of
from paretour.questions import (
    LEAST_OPTIONS,
    MOST_OPTIONS,
    MOST_QUESTIONS,
    OPTIONS,
    QUESTIONS,
    Question,
    ask,
)
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from service.requests.tour import refusal_of

_Pick = Annotated[int, Field(ge=0, lt=MOST_OPTIONS)]


def _split(texts: Any) -> Any:
    """Return the parts of a list's texts at their commas: `?picks=0,2` means `?picks=0&picks=2`."""
    if not isinstance(texts, list):
        return texts
    return [part for text in texts if text != "" for part in str(text).split(",")]


class QuestionsQuery(BaseModel):
    """The query parameters of `GET /front/{id}/questions`."""

    model_config = ConfigDict(extra="forbid")

    picks: Annotated[list[_Pick], BeforeValidator(_split)] = Field(
        default_factory=list,
        max_length=MOST_QUESTIONS,
        description="for each question so far the number of the option that was picked, from 0, as"
        " `0,2`",
    )
    questions: int = Field(
        default=QUESTIONS,
        ge=1,
        le=MOST_QUESTIONS,
        description="how many questions there are; fewer where a single tour is left before",
    )
    options: int = Field(
        default=OPTIONS,
        ge=LEAST_OPTIONS,
        le=MOST_OPTIONS,
        description="how many options a question has; fewer where as many tours are not left",
    )

    def ask(self, lengths: NDArray[np.float64]) -> Question:
        """Return the question about a front that follows the picks.

        Args:
            lengths: The lengths of the front's tours, shape (k, m), k at least 1.

        Raises:
            Refusal: A pick is not the number of an option, or there are too many picks.
        """
        try:
            return ask(lengths, self.picks, questions=self.questions, options=self.options)
        except WrongChoice as error:
            raise refusal_of(error) from None


def members_of(question: Question) -> dict[str, Any]:
    """Return the members of the answer that asks a question, ready for JSON."""
    chosen = {} if question.chosen is None else {"number": question.chosen}
    current, options = document_of(question.current), document_of(question.options)
    return {"left": question.left, **current, "options": options, **chosen}
