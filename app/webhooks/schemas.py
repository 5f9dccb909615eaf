"""Bodies of the webhooks' requests and answers."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from app.schemas import Document, Line, Moment
from app.webhooks.models import Delivery

Url = Annotated[Line, Field(min_length=1, max_length=2000)]
EventName = Annotated[Line, Field(max_length=32)]
Events = Annotated[list[EventName], Field(min_length=1, max_length=20)]
Description = Annotated[Line, Field(max_length=200)]

WEBHOOK_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0007",
    "url": "https://workshop.example.org/ponthy",
    "events": ["health.alert", "health.cleared"],
    "active": True,
    "description": "the workshop's ticket system",
    "failing_since": None,
    "created_at": "2026-03-01T08:00:00Z",
}
DELIVERY_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0008",
    "event_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0009",
    "event": "trip.ready",
    "state": "delivered",
    "attempts": 1,
    "next_try_at": None,
    "tried_at": "2026-03-01T08:00:01Z",
    "status": 204,
    "error": None,
    "answer": "",
    "delivered_at": "2026-03-01T08:00:01Z",
    "created_at": "2026-03-01T08:00:00Z",
    "payload": {
        "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0009",
        "event": "trip.ready",
        "created_at": "2026-03-01T08:00:00Z",
        "data": {"trip_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0002"},
    },
}


class WebhookRequest(Document):
    """A webhook to be made."""

    model_config = ConfigDict(
        json_schema_extra={"example": {name: WEBHOOK_EXAMPLE[name] for name in ("url", "events", "description")}}
    )

    url: Url
    events: Events
    description: Description = ""


class WebhookChange(Document):
    """What to change of a webhook; what is left out stays."""

    model_config = ConfigDict(json_schema_extra={"example": {"active": False}})

    url: Url | None = None
    events: Events | None = None
    active: bool | None = None
    description: Description | None = None


class WebhookDocument(Document):
    """A webhook, without its secret."""

    model_config = ConfigDict(json_schema_extra={"example": WEBHOOK_EXAMPLE})

    id: str
    url: str
    events: list[str]
    active: bool
    description: str
    failing_since: Moment | None = Field(description="Since when the address takes nothing; null when it does.")
    created_at: Moment


class NewWebhookDocument(WebhookDocument):
    """A webhook with its secret, which is shown this once."""

    model_config = ConfigDict(json_schema_extra={"example": WEBHOOK_EXAMPLE | {"secret": "whsec_…"}})

    secret: str


class DeliveryDocument(Document):
    """One event on its way to one webhook."""

    model_config = ConfigDict(json_schema_extra={"example": DELIVERY_EXAMPLE})

    id: str
    event_id: str = Field(description="The same in every webhook's delivery of one event.")
    event: str
    state: Literal["waiting", "delivered", "dead"]
    attempts: int
    next_try_at: Moment | None = Field(description="When it is tried again; null when it is over.")
    tried_at: Moment | None
    status: int | None = Field(description="HTTP status of the last answer; null when there was none.")
    error: str | None = Field(description="Why the last try failed.")
    answer: str | None = Field(description="The beginning of the last answer's body.")
    delivered_at: Moment | None
    created_at: Moment
    payload: dict[str, Any] = Field(description="The body that is sent.")

    @classmethod
    def of(cls, row: Delivery) -> DeliveryDocument:
        """Return the document of a delivery."""
        document = cls.model_validate(row)
        return document if document.state == "waiting" else document.model_copy(update={"next_try_at": None})
