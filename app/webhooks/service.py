"""What others may ask of the webhooks: tell them of an event."""

from __future__ import annotations

from app.webhooks.publishing import publish

__all__ = ["publish"]
