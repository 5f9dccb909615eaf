"""Who may do what, and the mechanics behind it: secrets, passwords, scopes, and where a request may come from."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from dataclasses import dataclass
from functools import cache
from typing import Literal
from urllib.parse import urlsplit

from argon2 import PasswordHasher
from argon2.exceptions import Argon2Error, InvalidHashError

from app.errors import PonthyError
from app.settings import Settings, is_loopback_host

Scope = Literal["read", "write"]

SCOPES: dict[Scope, frozenset[str]] = {
    "read": frozenset({"GET", "HEAD", "OPTIONS"}),
    "write": frozenset({"GET", "HEAD", "OPTIONS", "POST", "PUT", "PATCH", "DELETE"}),
}
"""The methods that each scope may use."""

SAFE_METHODS = SCOPES["read"]
SESSION_COOKIE = "ponthy_session"
TOKEN_START = "ponthy_"  # noqa: S105 - what every token begins with, not a secret


@dataclass(frozen=True, slots=True)
class Principal:
    """On whose behalf a request is made.

    Attributes
    ----------
    fleet_id : str
    scope : str
        ``read`` or ``write``.
    means : str
        ``loopback`` (the one person at this machine), ``session`` (a cookie) or ``token``.
    user_id : str or None
        The person, where one has logged in.
    """

    fleet_id: str
    scope: Scope
    means: Literal["loopback", "session", "token"]
    user_id: str | None = None

    def may(self, method: str) -> bool:
        """Whether this principal may use an HTTP method."""
        return method.upper() in SCOPES[self.scope]


@dataclass(frozen=True, slots=True)
class NewToken:
    """A token as it is shown once: its public prefix and the whole text."""

    prefix: str
    text: str


def new_token() -> NewToken:
    """Make a token for a script: ``ponthy_<prefix>_<secret>``."""
    prefix = secrets.token_hex(4)
    return NewToken(prefix, f"{TOKEN_START}{prefix}_{secrets.token_urlsafe(32)}")


def token_prefix(text: str) -> str | None:
    """Return the prefix of a token's text, or None where it has not the shape of one."""
    start, _, rest = text.partition("_")
    prefix, _, secret = rest.partition("_")
    return prefix if f"{start}_" == TOKEN_START and len(prefix) == 8 and secret else None


def new_secret() -> str:
    """Make a secret for a cookie."""
    return secrets.token_urlsafe(32)


def secret_hash(text: str) -> str:
    """Return what is kept of a long random secret; nothing slower is needed, because it can't be guessed."""
    return hashlib.sha256(text.encode()).hexdigest()


def same_secret(text: str, kept_hash: str) -> bool:
    """Whether a secret is the one whose hash was kept, in constant time."""
    return hmac.compare_digest(secret_hash(text), kept_hash)


def hash_password(password: str) -> str:
    """Return the Argon2id hash of a password."""
    return _hasher().hash(password)


def verify_password(password: str, kept_hash: str | None) -> bool:
    """Whether a password fits a hash. Without a hash (nobody of that name) it takes as long and says no."""
    try:
        return _hasher().verify(kept_hash or _nobodys_hash(), password) and kept_hash is not None
    except (Argon2Error, InvalidHashError):
        return False


@cache
def _hasher() -> PasswordHasher:
    return PasswordHasher()


@cache
def _nobodys_hash() -> str:
    return hash_password(secrets.token_urlsafe(16))


def check_host(settings: Settings, host: str | None) -> None:
    """Refuse a request that reached a loopback server under a foreign name, as a rebound DNS name would."""
    if not settings.is_loopback:
        return
    name = _host_name(host or "")
    known = {settings.host, _host_name(urlsplit(settings.public_url or "").netloc)}
    if not name or not (is_loopback_host(name) or name in known):
        message = (
            f"This Ponthy answers to localhost only, not to {host!r}. Set PONTHY_PUBLIC_URL to allow another name."
        )
        raise PonthyError("misdirected-request", message, 421)


def check_origin(settings: Settings, method: str, headers: dict[str, str]) -> None:
    """Refuse a changing request that a page of another site had a browser send.

    Browsers say where a request comes from in ``Sec-Fetch-Site`` or ``Origin``; a request with neither is from a
    program, which no other site can steer.
    """
    if method in SAFE_METHODS:
        return
    site = headers.get("sec-fetch-site")
    origin = headers.get("origin")
    own = {headers.get("host", ""), urlsplit(settings.public_url or "").netloc}
    if site is not None:
        fine = site in ("same-origin", "none") or (origin is not None and urlsplit(origin).netloc in own - {""})
    else:
        fine = origin is None or urlsplit(origin).netloc in own - {""}
    if not fine:
        message = "Another site's page sent this request. Open Ponthy itself, or use an API token from a program."
        raise PonthyError("cross-origin-request", message, 403)


def _host_name(netloc: str) -> str:
    try:
        return urlsplit(f"//{netloc}").hostname or ""
    except ValueError:
        return ""


SECURITY_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'self'; script-src 'self'; worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; "
        "img-src 'self' data: blob:; connect-src 'self'; object-src 'none'; base-uri 'none'; form-action 'self'; "
        "frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
}
"""Headers of every answer. Plotly draws with inline styles and workers made from blobs; nothing else is loosened."""


def security_headers(settings: Settings) -> dict[str, str]:
    """Return the headers of every answer, with the tile source and HTTPS where they are configured."""
    headers = dict(SECURITY_HEADERS)
    if settings.tiles_url:
        parts = urlsplit(settings.tiles_url)
        source = f"{parts.scheme}://{parts.netloc.replace('{s}', '*')}"
        policy = headers["Content-Security-Policy"]
        for directive in ("img-src 'self'", "connect-src 'self'"):
            policy = policy.replace(directive, f"{directive} {source}")
        headers["Content-Security-Policy"] = policy
    if (settings.public_url or "").startswith("https://"):
        headers["Strict-Transport-Security"] = "max-age=31536000"
    return headers
