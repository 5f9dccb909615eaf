"""The signature by which a receiver knows that a delivery is ours, is whole and is not an old one sent again."""

from __future__ import annotations

import hashlib
import hmac
import secrets

SECRET_START = "whsec_"  # noqa: S105 - what every secret begins with, not a secret
VERSION = "v1"


def new_secret() -> str:
    """Make the secret of a webhook."""
    return SECRET_START + secrets.token_urlsafe(32)


def signature(secret: str, timestamp: str, body: bytes) -> str:
    """Return the signature of a body sent at a time: HMAC-SHA256 over the time, a dot and the body, in hex."""
    digest = hmac.new(secret.encode(), timestamp.encode() + b"." + body, hashlib.sha256).hexdigest()
    return f"{VERSION}={digest}"
