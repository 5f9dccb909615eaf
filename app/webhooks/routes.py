"""Webhooks over REST."""

from __future__ import annotations

from fastapi import APIRouter

from app.edge import OpenResources, ReadSession, WriteSession
from app.schemas import Cursor, Id, Limit, Listing
from app.storage.paging import DEFAULT_LIMIT
from app.webhooks import schemas, service
from app.webhooks.schemas import DeliveryDocument, NewWebhookDocument, WebhookDocument

router = APIRouter(prefix="/webhooks", tags=["webhooks"])


@router.get("")
def list_webhooks(
    session: ReadSession, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[WebhookDocument]:
    """List the fleet's webhooks, newest first."""
    return Listing[WebhookDocument].model_validate(service.page(session, cursor, limit))


@router.post("", status_code=201)
def add_webhook(body: schemas.WebhookRequest, session: WriteSession, resources: OpenResources) -> NewWebhookDocument:
    """Have an address told of events; the secret that signs them is in this answer and nowhere else."""
    wanted = body.model_dump()
    return NewWebhookDocument.model_validate(service.add(session, resources.settings, **wanted))


@router.get("/{webhook_id}")
def show_webhook(webhook_id: Id, session: ReadSession) -> WebhookDocument:
    """Return a webhook."""
    return WebhookDocument.model_validate(service.get(session, webhook_id))


@router.patch("/{webhook_id}")
def change_webhook(
    webhook_id: Id, body: schemas.WebhookChange, session: WriteSession, resources: OpenResources
) -> WebhookDocument:
    """Change a webhook, or switch it off and on; what waits for one that is off is sent when it is on again."""
    return WebhookDocument.model_validate(service.change(session, resources.settings, webhook_id, body))


@router.delete("/{webhook_id}", status_code=204)
def delete_webhook(webhook_id: Id, session: WriteSession) -> None:
    """Remove a webhook with all it was told."""
    service.remove(session, webhook_id)


@router.post("/{webhook_id}/secret")
def renew_secret(webhook_id: Id, session: WriteSession) -> NewWebhookDocument:
    """Make a new secret, which is in this answer and nowhere else; the old one signs nothing from now on."""
    return NewWebhookDocument.model_validate(service.new_secret_of(session, webhook_id))


@router.post("/{webhook_id}/test", status_code=202)
def send_test(webhook_id: Id, session: WriteSession) -> DeliveryDocument:
    """Send the event `webhook.test`, whatever the webhook asks for."""
    return DeliveryDocument.of(service.test(session, webhook_id))


@router.get("/{webhook_id}/deliveries")
def list_deliveries(
    webhook_id: Id, session: ReadSession, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[DeliveryDocument]:
    """List what a webhook was told and is to be told, newest first."""
    page = service.deliveries(session, webhook_id, cursor, limit)
    items = [DeliveryDocument.of(row) for row in page.items]
    return Listing[DeliveryDocument](items=items, next_cursor=page.next_cursor)


@router.post("/{webhook_id}/deliveries/{delivery_id}/again", status_code=202)
def deliver_again(webhook_id: Id, delivery_id: Id, session: WriteSession) -> DeliveryDocument:
    """Send the same once more, with the same identifiers and tried again from the beginning."""
    return DeliveryDocument.of(service.deliver_again(session, webhook_id, delivery_id))
