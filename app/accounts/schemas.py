"""Bodies of the accounts' requests and answers."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from app.schemas import Document, Line, Moment, Name


class Credentials(Document):
    """What a person types to log in."""

    model_config = ConfigDict(json_schema_extra={"example": {"email": "ada@example.org", "password": "correct horse"}})

    email: Line = Field(max_length=320)
    password: str = Field(max_length=1000)


class FleetDocument(Document):
    """The owner of what is shown."""

    id: str
    name: str


class UserDocument(Document):
    """The person who is logged in."""

    id: str
    email: str
    name: str


class DemoDocument(Document):
    """Whether a demo car can be made, and the job that makes one at the moment."""

    available: bool
    job_id: str | None


class TilesDocument(Document):
    """The configured source of map tiles."""

    url: str
    attribution: str


class SessionDocument(Document):
    """Who is here, and what this Ponthy is."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "mode": "loopback",
                "fleet": {"id": "00000000000000000000000000000001", "name": "My fleet"},
                "user": None,
                "version": "0.1.0",
                "code_version": "0.1.0+3f2a9c0d1b7e",
                "demo": {"available": True, "job_id": None},
                "tiles": None,
            }
        }
    )

    mode: Literal["loopback", "authenticated"]
    fleet: FleetDocument
    user: UserDocument | None
    version: str
    code_version: str
    demo: DemoDocument
    tiles: TilesDocument | None


class TokenRequest(Document):
    """A token to be made."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "uploader in the garage", "scope": "write"}})

    name: Name
    scope: Literal["read", "write"] = "write"


TOKEN_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0006",
    "name": "uploader in the garage",
    "prefix": "1f0c9a3e",
    "scope": "write",
    "created_at": "2026-03-01T08:00:00Z",
    "last_used_at": None,
}


class TokenDocument(Document):
    """A token, without its secret."""

    model_config = ConfigDict(json_schema_extra={"example": TOKEN_EXAMPLE})

    id: str
    name: str
    prefix: str
    scope: Literal["read", "write"]
    created_at: Moment
    last_used_at: Moment | None


class NewTokenDocument(TokenDocument):
    """A token with its text, which is shown this once."""

    model_config = ConfigDict(json_schema_extra={"example": TOKEN_EXAMPLE | {"token": "ponthy_1f0c9a3e_…"}})

    token: str
