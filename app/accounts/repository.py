"""SQL of the accounts."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Session

from app.accounts.models import ApiToken, Fleet, LoginFailure, LoginSession, User
from app.storage.paging import DEFAULT_LIMIT, Page, newest_first


def fleet(session: Session, fleet_id: str) -> Fleet | None:
    """Return a fleet."""
    return session.get(Fleet, fleet_id)


def fleet_named(session: Session, name: str) -> Fleet | None:
    """Return the first fleet of a name."""
    return session.scalars(select(Fleet).where(Fleet.name == name).order_by(Fleet.created_at).limit(1)).first()


def fleets(session: Session) -> Sequence[Fleet]:
    """Return all fleets, oldest first."""
    return session.scalars(select(Fleet).order_by(Fleet.created_at, Fleet.id)).all()


def user(session: Session, user_id: str) -> User | None:
    """Return a user."""
    return session.get(User, user_id)


def user_with_email(session: Session, email: str) -> User | None:
    """Return the user of an e-mail address, which is kept in lower case."""
    return session.scalars(select(User).where(User.email == email)).first()


def token_with_prefix(session: Session, prefix: str) -> ApiToken | None:
    """Return the token with a prefix."""
    return session.scalars(select(ApiToken).where(ApiToken.prefix == prefix)).first()


def token(session: Session, token_id: str) -> ApiToken | None:
    """Return a token."""
    return session.get(ApiToken, token_id)


def tokens(session: Session, cursor: str | None = None, limit: int = DEFAULT_LIMIT) -> Page[ApiToken]:
    """Return the tokens that are not revoked, newest first."""
    statement = select(ApiToken).where(ApiToken.revoked_at.is_(None))
    return newest_first(session, statement, ApiToken.created_at, ApiToken.id, cursor, limit)


def touch_token(session: Session, token_id: str, moment: datetime) -> None:
    """Note when a token was used."""
    session.execute(update(ApiToken).where(ApiToken.id == token_id).values(last_used_at=moment))


def login_session(session: Session, secret_hash: str) -> LoginSession | None:
    """Return the login of a cookie's secret."""
    return session.scalars(select(LoginSession).where(LoginSession.secret_hash == secret_hash)).first()


def forget_login(session: Session, secret_hash: str) -> None:
    """End a login."""
    session.execute(delete(LoginSession).where(LoginSession.secret_hash == secret_hash))


def forget_logins_before(session: Session, moment: datetime) -> None:
    """Remove logins that have expired."""
    session.execute(delete(LoginSession).where(LoginSession.expires_at < moment))


def forget_failures_before(session: Session, moment: datetime) -> None:
    """Remove failed logins older than a moment."""
    session.execute(delete(LoginFailure).where(LoginFailure.at < moment))


def failures(session: Session, who_hashes: Sequence[str]) -> int:
    """Return how often somebody has failed to log in: the most of any of the given names."""
    counts = (
        select(func.count(LoginFailure.id))
        .where(LoginFailure.who_hash.in_(who_hashes))
        .group_by(LoginFailure.who_hash)
        .order_by(func.count(LoginFailure.id).desc())
        .limit(1)
    )
    return session.scalar(counts) or 0
