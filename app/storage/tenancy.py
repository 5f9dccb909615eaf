"""Who owns a row. A session belongs to one fleet, and sees and writes that fleet's rows only.

Nobody writes a tenant filter by hand: one hook adds it to every ORM statement of the session, another stamps new
rows and refuses foreign ones. The few questions across fleets (finding a token's owner, the reaper) use a system
session, which has no fleet.
"""

from __future__ import annotations

from sqlalchemy import ForeignKey, event
from sqlalchemy.orm import Mapped, ORMExecuteState, Session, UOWTransaction, mapped_column, with_loader_criteria

from app.storage.base import Identifier

FLEET = "fleet_id"
SYSTEM = "system"
READ_ONLY = "read_only"


class TenancyError(RuntimeError):
    """A programming error: a session was used for what its fleet doesn't own, or for writing while it only reads."""


class FleetOwned:
    """Mixin of every table whose rows belong to a fleet."""

    fleet_id: Mapped[Identifier] = mapped_column(ForeignKey("fleets.id"), index=True)


class FleetSession(Session):
    """A session bound by ``info`` to one fleet, or to none when it is a system session."""


def fleet_of(session: Session) -> str:
    """Return the fleet a session belongs to; raises `TenancyError` for a system session."""
    fleet_id = session.info.get(FLEET)
    if not isinstance(fleet_id, str):
        raise TenancyError("this session has no fleet; open one with Database.transaction(fleet_id)")
    return fleet_id


@event.listens_for(FleetSession, "do_orm_execute")
def _see_own_rows_only(state: ORMExecuteState) -> None:
    if (state.is_insert or state.is_update or state.is_delete) and state.session.info.get(READ_ONLY):
        raise TenancyError("this session only reads; take a writing one")
    if state.session.info.get(SYSTEM):
        return
    fleet_id = fleet_of(state.session)
    if not state.is_orm_statement:
        raise TenancyError("only ORM statements can be filtered by fleet; select mapped classes, not tables or text")
    if state.is_insert:
        raise TenancyError("bulk inserts can't be stamped with a fleet; use session.add or session.add_all")
    if not state.is_column_load and not state.is_relationship_load:
        state.statement = state.statement.options(
            with_loader_criteria(FleetOwned, lambda cls: cls.fleet_id == fleet_id, include_aliases=True)
        )


@event.listens_for(FleetSession, "before_flush")
def _own_what_is_written(session: Session, _context: UOWTransaction, _instances: object) -> None:
    touched = [*session.new, *session.dirty, *session.deleted]
    if touched and session.info.get(READ_ONLY):
        raise TenancyError("this session only reads; take a writing one")
    if session.info.get(SYSTEM):
        return
    fleet_id = fleet_of(session)
    for row in touched:
        if not isinstance(row, FleetOwned):
            continue
        if row.fleet_id is None and row in session.new:
            row.fleet_id = fleet_id
        if row.fleet_id != fleet_id:
            raise TenancyError(f"a session of fleet {fleet_id} can't write a row of fleet {row.fleet_id}")
