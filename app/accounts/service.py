"""Fleets, users, tokens and logins: who asks, and on whose behalf."""

from __future__ import annotations

from datetime import timedelta
from typing import cast

from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from app.accounts import repository
from app.accounts.models import DEFAULT_FLEET_ID, ApiToken, Fleet, LoginFailure, LoginSession, User
from app.errors import Conflict, Invalid, NotFound, PonthyError
from app.security import (
    Principal,
    Scope,
    hash_password,
    new_secret,
    new_token,
    same_secret,
    secret_hash,
    token_prefix,
    verify_password,
)
from app.settings import Settings
from app.storage.base import now
from app.storage.database import Database
from app.storage.paging import DEFAULT_LIMIT, Page
from app.storage.resources import Resources
from app.storage.tenancy import fleet_of

__all__ = [
    "DEFAULT_FLEET_ID",
    "add_fleet",
    "add_user",
    "authenticate",
    "create_token",
    "find_fleet",
    "fleet_ids",
    "log_in",
    "log_out",
    "own_fleet",
    "revoke_token",
    "signed_in_user",
    "tokens",
]

MIN_PASSWORD_LENGTH = 10
FAILURE_WINDOW = timedelta(minutes=15)
TOUCH_EVERY = timedelta(minutes=1)
"""``last_used_at`` of a token is no finer than this, so that reading doesn't write all the time."""


def add_fleet(session: Session, name: str) -> Fleet:
    """Make a fleet; needs a system session. Raises `Conflict` when there is one of that name, which finds a fleet."""
    if repository.fleet_named(session, name) is not None:
        raise Conflict("fleet-taken", f"There is a fleet called {name!r} already.")
    fleet = Fleet(name=name)
    session.add(fleet)
    session.flush()
    return fleet


def find_fleet(session: Session, name_or_id: str) -> Fleet:
    """Return a fleet by its name or identifier; raises `NotFound`."""
    found = repository.fleet(session, name_or_id) or repository.fleet_named(session, name_or_id)
    if found is None:
        raise NotFound("fleet", name_or_id)
    return found


def fleet_ids(session: Session) -> list[str]:
    """Return the identifiers of all fleets; needs a system session."""
    return [fleet.id for fleet in repository.fleets(session)]


def own_fleet(session: Session) -> Fleet:
    """Return the fleet a session belongs to."""
    return find_fleet(session, fleet_of(session))


def add_user(session: Session, email: str, password: str, name: str = "") -> User:
    """Add a person who may log in to the session's fleet.

    Raises
    ------
    Invalid
        When the address or the password can't be used.
    Conflict
        When somebody has the address already.
    """
    address = email.strip().lower()
    if "@" not in address or len(address) > 320:
        raise Invalid("bad-email", f"{email!r} is not an e-mail address.", field="email")
    if len(password) < MIN_PASSWORD_LENGTH:
        message = f"The password is too short; use {MIN_PASSWORD_LENGTH} characters or more."
        raise Invalid("weak-password", message, field="password")
    user = User(email=address, name=name.strip() or address.partition("@")[0], password_hash=hash_password(password))
    try:
        with session.begin_nested():
            session.add(user)
    except IntegrityError as error:
        raise Conflict("email-taken", f"Somebody with the address {address} exists already.") from error
    return user


def create_token(session: Session, name: str, scope: Scope = "write") -> tuple[ApiToken, str]:
    """Make a token of the session's fleet; return its row and its text, which is never shown again."""
    made = new_token()
    token = ApiToken(name=name, prefix=made.prefix, secret_hash=secret_hash(made.text), scope=scope)
    session.add(token)
    session.flush()
    return token, made.text


def tokens(session: Session, cursor: str | None = None, limit: int = DEFAULT_LIMIT) -> Page[ApiToken]:
    """Return the fleet's tokens that are not revoked."""
    return repository.tokens(session, cursor, limit)


def revoke_token(session: Session, token_id: str) -> None:
    """Make a token useless from now on; raises `NotFound`."""
    token = repository.token(session, token_id)
    if token is None or token.revoked_at is not None:
        raise NotFound("token", token_id)
    token.revoked_at = now()


def authenticate(resources: Resources, bearer: str | None, cookie: str | None) -> Principal | None:
    """Return who asks: the owner of a token, else of a session cookie, else the person at this machine, else None.

    A token that is sent but not valid is never overruled by a cookie or by sitting at the machine.
    """
    if bearer is not None:
        return _token_owner(resources.database, bearer)
    if resources.settings.is_loopback:
        return Principal(DEFAULT_FLEET_ID, "write", "loopback")
    return None if cookie is None else _cookie_owner(resources.database, cookie)


def _token_owner(database: Database, text: str) -> Principal | None:
    prefix = token_prefix(text)
    if prefix is None:
        return None
    with database.system_transaction(read_only=True) as session:
        token = repository.token_with_prefix(session, prefix)
    if token is None or token.revoked_at is not None or not same_secret(text, token.secret_hash):
        return None
    if token.last_used_at is None or now() - token.last_used_at > TOUCH_EVERY:
        with database.transaction(token.fleet_id) as session:
            repository.touch_token(session, token.id, now())
    return Principal(token.fleet_id, cast(Scope, token.scope), "token")


def _cookie_owner(database: Database, secret: str) -> Principal | None:
    with database.system_transaction(read_only=True) as session:
        login = repository.login_session(session, secret_hash(secret))
    if login is None or login.expires_at <= now():
        return None
    return Principal(login.fleet_id, "write", "session", login.user_id)


def log_in(resources: Resources, email: str, password: str, client: str) -> tuple[User, str]:
    """Check a password; return the person and the secret for their cookie.

    Parameters
    ----------
    resources : Resources
    email, password : str
    client : str
        Address of whoever tries; failures are counted for it and for the e-mail address.

    Raises
    ------
    PonthyError
        401 when address and password don't fit; 429 after too many failures.
    """
    address = email.strip().lower()
    who = [secret_hash(f"client {client}"), secret_hash(f"email {address}")]
    with resources.database.system_transaction() as session:
        repository.forget_failures_before(session, now() - FAILURE_WINDOW)
        repository.forget_logins_before(session, now())
        if repository.failures(session, who) >= resources.settings.login_attempts:
            wait = int(FAILURE_WINDOW.total_seconds())
            message = "Too many failed logins. Wait a quarter of an hour, then try again."
            raise PonthyError("too-many-logins", message, 429, headers={"Retry-After": str(wait)})
        user = repository.user_with_email(session, address)
    # Outside of any transaction: this takes a while on purpose.
    if not verify_password(password, None if user is None else user.password_hash) or user is None:
        with resources.database.system_transaction() as session:
            session.add_all(LoginFailure(who_hash=name) for name in who)
        raise PonthyError("login-failed", "E-mail address and password don't fit together.", 401)
    return user, _begin_login(resources.database, resources.settings, user)


def _begin_login(database: Database, settings: Settings, user: User) -> str:
    secret = new_secret()
    expires_at = now() + timedelta(hours=settings.session_hours)
    with database.transaction(user.fleet_id) as session:
        session.add(LoginSession(user_id=user.id, secret_hash=secret_hash(secret), expires_at=expires_at))
    return secret


def log_out(database: Database, cookie: str) -> None:
    """End the login of a cookie."""
    with database.system_transaction() as session:
        repository.forget_login(session, secret_hash(cookie))


def signed_in_user(session: Session, user_id: str | None) -> User | None:
    """Return the person who is logged in, where one is."""
    return None if user_id is None else repository.user(session, user_id)
