"""What is collected during a transaction and done after its commit, never before and never without it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy.orm import Session

OUTBOX = "outbox"
AFTERWARDS = "afterwards"


@dataclass(frozen=True, slots=True)
class Message:
    """A task to run: its name as the workers know it, and its arguments (JSON-able)."""

    task: str
    kwargs: dict[str, Any] = field(default_factory=dict)


Sender = Callable[[Message], None]
"""What brings a message to the queue."""


def enqueue(session: Session, task: str, **kwargs: Any) -> None:
    """Have a task sent once the session's transaction is committed."""
    session.info.setdefault(OUTBOX, []).append(Message(task, kwargs))


def afterwards(session: Session, action: Callable[[], None]) -> None:
    """Have something done once the session's transaction is committed, such as removing files nobody needs now.

    If the process dies in between it is not done, so it must be something that can be left out.
    """
    session.info.setdefault(AFTERWARDS, []).append(action)


def actions(session: Session) -> list[Callable[[], None]]:
    """Return, and forget, what is to be done afterwards."""
    collected_actions: list[Callable[[], None]] = session.info.pop(AFTERWARDS, [])
    return collected_actions


def collected(session: Session) -> list[Message]:
    """Return, and forget, what was enqueued."""
    messages: list[Message] = session.info.pop(OUTBOX, [])
    return messages
