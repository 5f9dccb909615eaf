"""Drawing an open-circuit curve that is not kept: while somebody edits it, or before a fitted one is taken."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field, model_validator

from app.answers import large_json
from app.edge import CurrentPrincipal
from app.figures.battery_curve import proposed_figure
from app.figures.theme import theme_named
from app.science.battery.curve import OpenCircuit
from app.science.battery.curve_reading import read_curve
from app.science.fields import Fields

MOST_ROWS = 5000

router = APIRouter(prefix="/batteries/curves", tags=["batteries"])
Column = Annotated[list[float | None] | None, Field(max_length=MOST_ROWS)]


class CurveToDraw(BaseModel):
    """A curve as configurations hold it, the one it would replace, and the rows of a fit.

    ``spread_v`` is charging less discharging voltage at the rows ``soc`` and ``volts``.
    """

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"ocv": [[0.0, 3.0], [0.5, 3.6], [1.0, 4.1]]}}
    )

    ocv: Annotated[list[Any], Field(max_length=MOST_ROWS)]
    ocv_soc_range: tuple[float, float] | None = None
    present: dict[str, Any] | None = None
    soc: Column = None
    volts: Column = None
    spread_v: Column = None

    @model_validator(mode="after")
    def _rows(self) -> CurveToDraw:
        lengths = {None if column is None else len(column) for column in (self.soc, self.volts, self.spread_v)}
        if len(lengths) != 1:
            raise ValueError("soc, volts and spread_v have one number a row each")
        return self


def _curve(document: dict[str, Any]) -> OpenCircuit:
    known = {name: document[name] for name in ("ocv", "ocv_soc_range") if document.get(name) is not None}
    return read_curve(Fields(known, what="curve"))


@router.post("/figure", response_model=dict[str, Any])
def draw_curve(
    request: Request, _: CurrentPrincipal, body: CurveToDraw, theme: Literal["light", "dark"] = "light"
) -> Response:
    """Draw a curve without keeping it: 422 with the row that is wrong."""
    document = body.model_dump(exclude_none=True)
    _curve(document)
    present = None if body.present is None else _curve(body.present)
    return large_json(request, proposed_figure(document, present, theme_named(theme)))
