"""Which of a car's trips count in its map, over REST."""

from __future__ import annotations

from fastapi import APIRouter

from app.edge import ReadSession, WriteSession
from app.maps import rules
from app.maps.schemas import RulesChange, RulesView
from app.schemas import Id

router = APIRouter(prefix="/cars/{car_id}/maps/rules", tags=["maps"])


@router.get("")
def show_rules(session: ReadSession, car_id: Id) -> RulesView:
    """Tell which of the car's trips count in its map."""
    return RulesView.model_validate(rules.show_rules(session, car_id))


@router.patch("")
def change_rules(session: WriteSession, car_id: Id, body: RulesChange) -> RulesView:
    """Change which trips count; the map is made anew as a further version. What is left out stays."""
    return RulesView.model_validate(rules.change_rules(session, car_id, body.model_dump(exclude_unset=True)))
