"""Fleets and who may act for them."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned

DEFAULT_FLEET_ID = "0" * 31 + "1"
"""The one fleet of an embedded Ponthy."""


class Fleet(Base):
    """The owner of everything else: cars, trips, jobs, users."""

    __tablename__ = "fleets"

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(200))
    created_at: Mapped[datetime] = mapped_column(default=now)


class User(FleetOwned, Base):
    """A person who logs in with an e-mail address and a password."""

    __tablename__ = "users"

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    email: Mapped[str] = mapped_column(String(320), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    password_hash: Mapped[str] = mapped_column(String(300))
    created_at: Mapped[datetime] = mapped_column(default=now)


class ApiToken(FleetOwned, Base):
    """A key for scripts. Only a hash of its secret is kept; the prefix finds the row and tells tokens apart."""

    __tablename__ = "api_tokens"

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(200))
    prefix: Mapped[str] = mapped_column(String(16), unique=True)
    secret_hash: Mapped[str] = mapped_column(String(64))
    scope: Mapped[str] = mapped_column(String(16))
    created_at: Mapped[datetime] = mapped_column(default=now)
    last_used_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]


class LoginSession(FleetOwned, Base):
    """A browser that has logged in; the cookie holds the secret, the row its hash."""

    __tablename__ = "login_sessions"

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    user_id: Mapped[Identifier] = mapped_column(ForeignKey("users.id", ondelete="CASCADE"), index=True)
    secret_hash: Mapped[str] = mapped_column(String(64), unique=True)
    created_at: Mapped[datetime] = mapped_column(default=now)
    expires_at: Mapped[datetime] = mapped_column(index=True)


class LoginFailure(Base):
    """A failed login, by a hash of who tried; enough of them and further tries must wait."""

    __tablename__ = "login_failures"

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    who_hash: Mapped[str] = mapped_column(String(64), index=True)
    at: Mapped[datetime] = mapped_column(default=now, index=True)
