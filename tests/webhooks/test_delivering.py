"""From an event to a receiver: signed, tried again until it is heard, and written down."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.accounts import service as accounts
from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.settings import Settings
from app.storage.base import now
from app.storage.resources import Resources
from app.webhooks import delivering, publishing, repository
from app.webhooks import service as webhooks
from app.webhooks.models import Delivery, Webhook
from tests.webhooks.conftest import Receiver
from workers.beats import look_after_deliveries

ROOT = Path(__file__).resolve().parents[2]
MEMBERS = ("health.alert", "trip.ready")


class Clock:
    """The time as the deliveries see it."""

    def __init__(self) -> None:
        self.ahead = timedelta()

    def __call__(self) -> datetime:
        return now() + self.ahead


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    for module in (delivering, publishing, webhooks):
        monkeypatch.setattr(module, "now", made)
    return made


@pytest.fixture
def webhook(resources: Resources, receiver: Receiver) -> Webhook:
    return subscribed(resources, FLEET, receiver.url)


def subscribed(resources: Resources, fleet_id: str, url: str) -> Webhook:
    with resources.database.transaction(fleet_id) as session:
        return webhooks.add(session, resources.settings, url=url, events=MEMBERS, description="")


def publish(resources: Resources, **data: Any) -> None:
    with resources.database.transaction(FLEET) as session:
        webhooks.publish(session, "health.alert", data)


def only(resources: Resources, webhook: Webhook) -> Delivery:
    with resources.database.transaction(FLEET, read_only=True) as session:
        (row,) = webhooks.deliveries(session, webhook.id, None, 10).items
        return row


def kept(resources: Resources, webhook: Webhook) -> Webhook:
    with resources.database.transaction(FLEET, read_only=True) as session:
        return webhooks.get(session, webhook.id)


def hmac_by_hand(key: bytes, message: bytes) -> str:
    """RFC 2104 in the open: H(K ⊕ opad, H(K ⊕ ipad, message))."""
    key = key.ljust(64, b"\0")
    inner = hashlib.sha256(bytes(byte ^ 0x36 for byte in key) + message).digest()
    return hashlib.sha256(bytes(byte ^ 0x5C for byte in key) + inner).hexdigest()


def test_a_delivery_is_signed_and_says_what_it_is(resources: Resources, receiver: Receiver, webhook: Webhook) -> None:
    receiver.answers.append((200, b"noted"))
    publish(resources, words="rolling resistance 18 % above its usual: check tyre pressures")
    row = only(resources, webhook)
    assert webhooks.deliver(resources, FLEET, row.id) == "delivered"
    (heard,) = receiver.heard
    assert heard.path == "/hook?from=ponthy"
    assert json.loads(heard.body) == row.payload
    assert heard.headers["Ponthy-Event"] == "health.alert"
    assert heard.headers["Ponthy-Delivery"] == row.id
    assert heard.headers["Content-Type"] == "application/json"
    signed = heard.headers["Ponthy-Timestamp"].encode() + b"." + heard.body
    assert heard.headers["Ponthy-Signature"] == f"v1={hmac_by_hand(webhook.secret.encode(), signed)}"
    row = only(resources, webhook)
    assert (row.state, row.attempts, row.status, row.answer, row.error) == ("delivered", 1, 200, "noted", None)
    assert webhooks.deliver(resources, FLEET, row.id) == "refused"
    assert len(receiver.heard) == 1


def test_the_example_in_the_documents_knows_a_delivery_from_a_forgery(
    resources: Resources, receiver: Receiver, webhook: Webhook
) -> None:
    document = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    (example,) = (code for code in re.findall(r"```python\n(.*?)```", document, re.DOTALL) if "is_from_ponthy" in code)
    namespace: dict[str, Any] = {}
    exec(example, namespace)  # noqa: S102 - our own document
    is_from_ponthy: Callable[[str, Any, bytes], bool] = namespace["is_from_ponthy"]
    publish(resources, change=0.18)
    webhooks.deliver(resources, FLEET, only(resources, webhook).id)
    (heard,) = receiver.heard
    assert is_from_ponthy(webhook.secret, heard.headers, heard.body)
    assert not is_from_ponthy("whsec_other", heard.headers, heard.body)
    assert not is_from_ponthy(webhook.secret, heard.headers, heard.body.replace(b"0.18", b"0.19"))
    old = heard.headers | {"Ponthy-Timestamp": str(int(heard.headers["Ponthy-Timestamp"]) - 3600)}
    assert not is_from_ponthy(webhook.secret, old, heard.body)


def test_what_was_refused_is_sent_again_with_growing_pauses(
    resources: Resources, receiver: Receiver, webhook: Webhook, clock: Clock
) -> None:
    receiver.answers += [(500, b"Traceback"), (503, b"")]
    publish(resources)
    delivery_id = only(resources, webhook).id
    assert webhooks.deliver(resources, FLEET, delivery_id) == "failed"
    row = only(resources, webhook)
    assert (row.state, row.status, row.answer) == ("waiting", 500, "Traceback")
    assert row.error == "the receiver answered 500"
    assert kept(resources, webhook).failing_since is not None
    assert webhooks.deliver(resources, FLEET, delivery_id) == "refused"
    clock.ahead += timedelta(seconds=11)
    assert webhooks.deliver(resources, FLEET, delivery_id) == "failed"
    clock.ahead += timedelta(seconds=11)
    assert webhooks.deliver(resources, FLEET, delivery_id) == "refused"
    clock.ahead += timedelta(seconds=25)
    look_after_deliveries(resources)
    row = only(resources, webhook)
    assert (row.state, row.attempts, row.error) == ("delivered", 3, None)
    assert kept(resources, webhook).failing_since is None
    assert len({heard.body for heard in receiver.heard}) == 1
    assert {heard.headers["Ponthy-Delivery"] for heard in receiver.heard} == {delivery_id}


def test_after_about_a_day_it_is_dead_and_can_be_sent_again(
    resources: Resources, receiver: Receiver, webhook: Webhook, clock: Clock
) -> None:
    receiver.answers += [(302, b"")] * 12
    publish(resources)
    began, delivery_id = clock(), only(resources, webhook).id
    outcomes = []
    for _ in range(12):
        outcomes.append(webhooks.deliver(resources, FLEET, delivery_id))
        last, clock.ahead = clock(), max(only(resources, webhook).next_try_at, clock()) - now() + timedelta(seconds=1)
    assert outcomes == ["failed"] * 11 + ["dead"]
    assert timedelta(hours=22) < last - began < timedelta(hours=26)
    row = only(resources, webhook)
    assert (row.state, row.error) == ("dead", "the receiver answered 302; redirections are not followed")
    assert len(receiver.heard) == 12
    clock.ahead += timedelta(days=1)
    look_after_deliveries(resources)
    assert len(receiver.heard) == 12
    with resources.database.transaction(FLEET) as session:
        webhooks.deliver_again(session, webhook.id, delivery_id)
    assert webhooks.deliver(resources, FLEET, delivery_id) == "delivered"


def test_an_address_that_fails_is_not_asked_for_each_event(
    resources: Resources, receiver: Receiver, webhook: Webhook, clock: Clock
) -> None:
    receiver.answers += [(500, b"")] * 2
    for number in range(5):
        publish(resources, number=number)
    clock.ahead += timedelta(seconds=5)
    look_after_deliveries(resources)
    assert len(receiver.heard) == 1
    clock.ahead += timedelta(seconds=13)
    look_after_deliveries(resources)
    assert len(receiver.heard) == 2
    clock.ahead += timedelta(seconds=65)
    look_after_deliveries(resources)
    assert len(receiver.heard) == 7
    sent = [json.loads(heard.body)["data"]["number"] for heard in receiver.heard[2:]]
    assert sorted(sent) == [0, 1, 2, 3, 4]


def test_of_two_workers_one_tries_and_a_dead_one_is_replaced(
    resources: Resources, receiver: Receiver, webhook: Webhook, clock: Clock
) -> None:
    publish(resources)
    delivery_id = only(resources, webhook).id
    with resources.database.transaction(FLEET) as session:
        assert repository.take(session, delivery_id, now(), now() + delivering.HELD)
    assert webhooks.deliver(resources, FLEET, delivery_id) == "refused"
    clock.ahead += delivering.HELD + timedelta(seconds=5)
    look_after_deliveries(resources)
    assert only(resources, webhook).attempts == 2
    with resources.database.transaction(FLEET) as session:
        assert not repository.settle(session, delivery_id, 1, state="dead")
    assert only(resources, webhook).state == "delivered"


def test_a_name_that_leads_inside_by_now_is_not_followed(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    """DNS rebinding: the name was fine when the webhook was made."""
    resources = Resources.open(settings.model_copy(update={"auth": True}))
    webhook = subscribed(resources, FLEET, "https://hooks.example.org:9/")
    answers = [(0, 0, 0, "", ("10.0.0.1", 9)), (0, 0, 0, "", ("127.0.0.1", 9))]
    fake = SimpleNamespace(getaddrinfo=lambda *_a, **_k: answers, SOCK_STREAM=1)
    monkeypatch.setattr("app.webhooks.addresses.socket", fake)
    publish(resources)
    assert webhooks.deliver(resources, FLEET, only(resources, webhook).id) == "failed"
    expected = "hooks.example.org does not resolve to an address that webhooks may reach"
    assert only(resources, webhook).error == expected
    resources.close()


def test_what_was_allowed_once_is_checked_each_time(resources: Resources, receiver: Receiver, webhook: Webhook) -> None:
    publish(resources)
    strict = Resources.open(resources.settings.model_copy(update={"auth": True}))
    assert webhooks.deliver(strict, FLEET, only(resources, webhook).id) == "failed"
    assert only(resources, webhook).error == "A webhook can't lead back to this server."
    assert receiver.heard == []
    strict.close()


def test_each_fleet_hears_of_its_own(resources: Resources, receiver: Receiver, webhook: Webhook) -> None:
    with resources.database.system_transaction() as session:
        others = accounts.add_fleet(session, "others").id
    theirs = subscribed(resources, others, receiver.url)
    publish(resources)
    with resources.database.system_transaction() as session:
        webhooks.publish(session, "trip.ready", {"by": "the reaper"}, fleet_id=others)
    assert only(resources, webhook).event == "health.alert"
    with resources.database.transaction(others, read_only=True) as session:
        (row,) = webhooks.deliveries(session, theirs.id, None, 10).items
    assert (row.event, row.fleet_id) == ("trip.ready", others)
    assert webhooks.deliver(resources, FLEET, row.id) == "refused"
    assert webhooks.deliver(resources, others, row.id) == "delivered"


def test_no_secret_and_no_address_is_logged(
    resources: Resources, receiver: Receiver, webhook: Webhook, capsys: pytest.CaptureFixture[str]
) -> None:
    receiver.answers.append((500, b"oops"))
    publish(resources)
    webhooks.deliver(resources, FLEET, only(resources, webhook).id)
    said = "".join(capsys.readouterr())
    assert webhook.id in said
    assert webhook.secret not in said
    assert str(receiver.port) not in said


def test_old_deliveries_are_forgotten_but_not_what_waits(
    resources: Resources, receiver: Receiver, webhook: Webhook
) -> None:
    publish(resources, number=1)
    webhooks.deliver(resources, FLEET, only(resources, webhook).id)
    publish(resources, number=2)
    assert webhooks.forget(resources, days=1) == 0
    assert webhooks.forget(resources, days=-1) == 1
    assert only(resources, webhook).payload["data"] == {"number": 2}
