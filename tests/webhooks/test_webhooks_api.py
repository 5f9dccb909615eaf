"""Webhooks over REST: made with a secret that is shown once, changed, tested, told again, removed."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.storage.resources import Resources
from app.webhooks import service as webhooks
from app.webhooks.models import EVENTS

HERE = "http://localhost:9/hook"
PATH = "/api/v1/webhooks"


def made(client: TestClient, **more: Any) -> dict[str, Any]:
    answer = client.post(PATH, json={"url": HERE, "events": ["trip.ready"]} | more)
    assert answer.status_code == 201, answer.text
    document: dict[str, Any] = answer.json()
    return document


def test_the_secret_is_shown_once(client: TestClient) -> None:
    first = made(client, description="  tickets ")
    assert first["secret"].startswith("whsec_")
    assert len(first["secret"]) == 49  # 256 random bits behind the prefix
    assert made(client)["secret"] != first["secret"]
    kept = {name: value for name, value in first.items() if name != "secret"}
    assert kept["description"] == "tickets"
    assert client.get(f"{PATH}/{first['id']}").json() == kept
    assert client.get(PATH).json()["items"][1] == kept
    told = client.post(f"{PATH}/{first['id']}/test")
    renewed = client.post(f"{PATH}/{first['id']}/secret").json()
    assert renewed["secret"] != first["secret"]
    pages = [client.get(path).text for path in (PATH, f"{PATH}/{first['id']}", f"{PATH}/{first['id']}/deliveries")]
    assert not [text for text in [*pages, told.text] if "whsec_" in text or '"secret"' in text]


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"url": "https://10.0.0.1/"}, "url", "10.0.0.1 is not a public address"),
        ({"url": "http://example.org/"}, "url", "Use https"),
        ({"events": ["trip.lost"]}, "events", "There is no event 'trip.lost'. Choose from trip.ready, trip.failed"),
        ({"events": ["webhook.test"]}, "events", "There is no event 'webhook.test'"),
    ],
)
def test_what_cannot_be_is_refused_with_a_reason(
    client: TestClient, change: dict[str, Any], field: str, words: str
) -> None:
    webhook = made(client)
    for answer in (
        client.post(PATH, json={"url": HERE, "events": ["trip.ready"]} | change),
        client.patch(f"{PATH}/{webhook['id']}", json=change),
    ):
        assert answer.status_code == 422
        assert answer.json()["field"] == field
        assert words in answer.json()["detail"]


def test_a_webhook_is_changed_in_what_is_given(client: TestClient) -> None:
    webhook = made(client)
    change = {"events": ["health.cleared", "map.updated", "map.updated"], "active": False}
    changed = client.patch(f"{PATH}/{webhook['id']}", json=change).json()
    assert changed["events"] == ["map.updated", "health.cleared"]
    assert (changed["url"], changed["active"]) == (HERE, False)
    assert client.delete(f"{PATH}/{webhook['id']}").status_code == 204
    assert client.get(f"{PATH}/{webhook['id']}").status_code == 404


def test_there_are_not_more_than_anybody_needs(client: TestClient) -> None:
    for _ in range(webhooks.MOST):
        made(client)
    answer = client.post(PATH, json={"url": HERE, "events": ["trip.ready"]})
    assert (answer.status_code, answer.json()["code"]) == (409, "too-many-webhooks")


def test_only_those_who_asked_are_told(client: TestClient, resources: Resources) -> None:
    wanted, other = made(client, events=list(EVENTS)), made(client, events=["map.updated"])
    off = made(client, events=list(EVENTS))
    client.patch(f"{PATH}/{off['id']}", json={"active": False})
    with resources.database.transaction(FLEET) as session:
        webhooks.publish(session, "health.alert", {"car_id": "c", "change": 0.18, "sd": float("nan")})
    (delivery,) = client.get(f"{PATH}/{wanted['id']}/deliveries").json()["items"]
    assert (delivery["event"], delivery["state"], delivery["attempts"]) == ("health.alert", "waiting", 0)
    assert delivery["payload"]["data"] == {"car_id": "c", "change": 0.18, "sd": None}
    assert (delivery["payload"]["id"], delivery["payload"]["event"]) == (delivery["event_id"], "health.alert")
    for silent in (other, off):
        assert client.get(f"{PATH}/{silent['id']}/deliveries").json()["items"] == []


def test_nothing_is_told_of_what_was_not_committed(client: TestClient, resources: Resources) -> None:
    webhook = made(client)
    session = resources.database.session(FLEET)
    webhooks.publish(session, "trip.ready", {})
    session.rollback()
    session.close()
    assert client.get(f"{PATH}/{webhook['id']}/deliveries").json()["items"] == []
    assert resources.queue.size() == 0


def test_an_unknown_event_is_a_fault_of_the_program(resources: Resources) -> None:
    with pytest.raises(ValueError, match=r"'trip\.lost' is not an event"), resources.database.transaction(FLEET) as s:
        webhooks.publish(s, "trip.lost", {})


def test_nothing_is_sent_again_while_the_webhook_is_off(client: TestClient) -> None:
    webhook = made(client)
    told = client.post(f"{PATH}/{webhook['id']}/test")
    assert told.status_code == 202
    client.patch(f"{PATH}/{webhook['id']}", json={"active": False})
    again = f"{PATH}/{webhook['id']}/deliveries/{told.json()['id']}/again"
    assert client.post(again).json()["code"] == "webhook-inactive"
    assert client.post(again.replace(told.json()["id"], "0" * 32)).status_code == 404
