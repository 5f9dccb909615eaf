"""Who gets in: people with passwords, scripts with tokens, and nobody else."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import timedelta

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import select

from app.accounts import service
from app.accounts.models import DEFAULT_FLEET_ID, ApiToken, LoginSession, User
from app.errors import Conflict, Invalid
from app.main import create_app
from app.security import SESSION_COOKIE, new_token, token_prefix
from app.settings import Settings
from app.storage.base import now
from app.storage.resources import Resources

ADDRESS, PASSWORD = "ada@example.org", "correct horse battery"


@pytest.fixture
def guarded(settings: Settings) -> Settings:
    """Return settings of a Ponthy that asks for a login."""
    return settings.model_copy(update={"auth": True})


@pytest.fixture
def browser(guarded: Settings) -> Iterator[TestClient]:
    with TestClient(create_app(guarded), base_url="https://ponthy.example") as client:
        yield client


@pytest.fixture
def ada(resources: Resources) -> str:
    with resources.database.transaction(DEFAULT_FLEET_ID) as session:
        return service.add_user(session, " Ada@Example.org", PASSWORD, "Ada").id


def token_for(resources: Resources, scope: str = "write", fleet: str = DEFAULT_FLEET_ID) -> tuple[str, dict[str, str]]:
    with resources.database.transaction(fleet) as session:
        row, text = service.create_token(session, "test", scope)  # type: ignore[arg-type]  # a scope
        return row.id, {"Authorization": f"Bearer {text}"}


def log_in(browser: TestClient, password: str = PASSWORD, email: str = ADDRESS) -> int:
    return browser.post("/api/v1/session", json={"email": email, "password": password}).status_code


def test_the_unknown_are_asked_to_sign_in(browser: TestClient) -> None:
    answer = browser.get("/api/v1/session")
    assert (answer.status_code, answer.json()["code"]) == (401, "unauthenticated")
    assert answer.headers["WWW-Authenticate"] == "Bearer"


def test_a_person_logs_in_and_out(browser: TestClient, ada: str) -> None:
    answer = browser.post("/api/v1/session", json={"email": ADDRESS, "password": PASSWORD})
    assert answer.status_code == 204
    cookie = answer.headers["Set-Cookie"]
    assert {"HttpOnly", "Secure", "SameSite=strict", "Path=/"} <= {part.strip() for part in cookie.split(";")}
    session = browser.get("/api/v1/session").json()
    assert session["mode"] == "authenticated"
    assert session["user"] == {"id": ada, "email": ADDRESS, "name": "Ada"}
    assert session["fleet"]["id"] == DEFAULT_FLEET_ID
    kept = browser.cookies[SESSION_COOKIE]
    assert browser.delete("/api/v1/session").status_code == 204
    browser.cookies.set(SESSION_COOKIE, kept)
    assert browser.get("/api/v1/session").status_code == 401


def test_the_cookie_is_not_secure_where_there_is_no_https(guarded: Settings, ada: str) -> None:
    with TestClient(create_app(guarded), base_url="http://10.0.0.7:8321") as plain:
        answer = plain.post("/api/v1/session", json={"email": ADDRESS, "password": PASSWORD})
        assert "Secure" not in answer.headers["Set-Cookie"]


@pytest.mark.parametrize(("email", "password"), [(ADDRESS, "wrong"), ("nobody@example.org", PASSWORD), (ADDRESS, "")])
def test_a_wrong_login_says_no_more_than_that(browser: TestClient, ada: str, email: str, password: str) -> None:
    answer = browser.post("/api/v1/session", json={"email": email, "password": password})
    assert (answer.status_code, answer.json()["code"]) == (401, "login-failed")
    assert answer.json()["detail"] == "E-mail address and password don't fit together."


def test_a_login_ends_when_it_expires(browser: TestClient, ada: str, resources: Resources) -> None:
    log_in(browser)
    with resources.database.transaction(DEFAULT_FLEET_ID) as session:
        session.scalars(select(LoginSession)).one().expires_at = now() - timedelta(seconds=1)
    assert browser.get("/api/v1/session").status_code == 401


def test_guessing_passwords_is_stopped(guarded: Settings, ada: str) -> None:
    patient = guarded.model_copy(update={"login_attempts": 3})
    with TestClient(create_app(patient), base_url="https://ponthy.example") as browser:
        assert [log_in(browser, "guess") for _ in range(3)] == [401, 401, 401]
        answer = browser.post("/api/v1/session", json={"email": ADDRESS, "password": PASSWORD})
    assert (answer.status_code, answer.json()["code"]) == (429, "too-many-logins")
    assert int(answer.headers["Retry-After"]) > 0


def test_secrets_are_not_kept(browser: TestClient, ada: str, resources: Resources) -> None:
    log_in(browser)
    _, headers = token_for(resources)
    with resources.database.transaction(DEFAULT_FLEET_ID, read_only=True) as session:
        kept = (
            " ".join(
                str(column)
                for row in (*session.scalars(select(User)), *session.scalars(select(ApiToken)))
                for column in vars(row).values()
            )
            + session.scalars(select(LoginSession)).one().secret_hash
        )
    secret = headers["Authorization"].split("_", 2)[2]
    assert PASSWORD not in kept
    assert secret not in kept
    assert browser.cookies[SESSION_COOKIE] not in kept
    assert "$argon2id$" in kept


def test_a_token_reads_and_writes(browser: TestClient, resources: Resources) -> None:
    token_id, headers = token_for(resources)
    assert browser.post("/api/v1/cars", json={"name": "x"}, headers=headers).status_code == 201
    with resources.database.transaction(DEFAULT_FLEET_ID, read_only=True) as session:
        assert session.get_one(ApiToken, token_id).last_used_at is not None


def test_a_reading_token_does_not_write(browser: TestClient, resources: Resources) -> None:
    _, headers = token_for(resources, "read")
    assert browser.get("/api/v1/cars", headers=headers).status_code == 200
    answer = browser.post("/api/v1/cars", json={}, headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (403, "forbidden")


def test_a_revoked_token_is_useless(browser: TestClient, resources: Resources, ada: str) -> None:
    token_id, headers = token_for(resources)
    log_in(browser)
    assert browser.delete(f"/api/v1/tokens/{token_id}").status_code == 204
    assert browser.delete(f"/api/v1/tokens/{token_id}").status_code == 404
    browser.cookies.clear()
    assert browser.get("/api/v1/cars", headers=headers).status_code == 401


@pytest.mark.parametrize("text", ["", "x", "ponthy_", "ponthy_0123abcd_", "ponthy_0123abcd_guess", "Basic YTpi"])
def test_what_is_no_token_does_not_let_in(client: TestClient, text: str) -> None:
    """Also on loopback, where without any token everything would be allowed."""
    status = client.get("/api/v1/cars", headers={"Authorization": f"Bearer {text}"}).status_code
    assert status == (200 if not text else 401)


def test_tokens_are_made_by_people(browser: TestClient, resources: Resources, ada: str) -> None:
    _, headers = token_for(resources)
    assert browser.post("/api/v1/tokens", json={"name": "more"}, headers=headers).status_code == 403
    log_in(browser)
    made = browser.post("/api/v1/tokens", json={"name": "garage", "scope": "read"}).json()
    assert token_prefix(made["token"]) == made["prefix"]
    listed = browser.get("/api/v1/tokens").json()["items"]
    assert [token["name"] for token in listed] == ["garage", "test"]
    assert all("token" not in token for token in listed)


def test_every_new_token_is_another(resources: Resources) -> None:
    assert new_token().text != new_token().text


@pytest.mark.parametrize(("email", "password"), [("ada", PASSWORD), (ADDRESS, "short")])
def test_a_user_needs_an_address_and_a_long_password(resources: Resources, email: str, password: str) -> None:
    with pytest.raises(Invalid), resources.database.transaction(DEFAULT_FLEET_ID) as session:
        service.add_user(session, email, password)


def test_an_address_is_taken_once_in_any_fleet(resources: Resources, ada: str) -> None:
    with resources.database.system_transaction() as session:
        other = service.add_fleet(session, "other").id
    with pytest.raises(Conflict), resources.database.transaction(other) as session:
        service.add_user(session, "ADA@example.org", PASSWORD)
