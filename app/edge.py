"""What a route may ask for: who asks, a session of their fleet, the process's resources.

Sessions belong to the request: they are committed when the route's function has returned and before its answer is
sent, and what was enqueued is sent right after. Routes themselves never commit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy.orm import Session

from app.errors import PonthyError
from app.security import SESSION_COOKIE, Principal
from app.storage.resources import Resources

API = "/api/v1"
"""Where the API stands."""
Authenticate = Callable[[Resources, str | None, str | None], Principal | None]
"""Finds the principal of a bearer token or else a session cookie; either may be None."""


def resources(request: Request) -> Resources:
    """Return what the process holds open."""
    opened: Resources = request.app.state.resources
    return opened


def maybe_principal(request: Request) -> Principal | None:
    """Return who asks, or None for somebody unknown."""
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    bearer = token.strip() if scheme.lower() == "bearer" and token.strip() else None
    authenticate: Authenticate = request.app.state.authenticate
    return authenticate(resources(request), bearer, request.cookies.get(SESSION_COOKIE))


def principal(request: Request, known: Annotated[Principal | None, Depends(maybe_principal)]) -> Principal:
    """Return who asks; refuse the unknown, and those whose scope doesn't cover the method."""
    if known is None:
        message = "Sign in, or send an API token as 'Authorization: Bearer …'."
        raise PonthyError("unauthenticated", message, 401, headers={"WWW-Authenticate": "Bearer"})
    request.state.fleet_id = known.fleet_id  # for the log; this may run in a thread with a context of its own
    if not known.may(request.method):
        message = f"This token's scope is {known.scope!r}; {request.method} needs 'write'. Make a token that may write."
        raise PonthyError("forbidden", message, 403)
    return known


def _reading(request: Request, who: Annotated[Principal, Depends(principal)]) -> Iterator[Session]:
    with resources(request).database.transaction(who.fleet_id, read_only=True) as session:
        yield session


def _writing(request: Request, who: Annotated[Principal, Depends(principal)]) -> Iterator[Session]:
    with resources(request).database.transaction(who.fleet_id) as session:
        yield session


def page_session(
    request: Request, known: Annotated[Principal | None, Depends(maybe_principal)]
) -> Iterator[Session | None]:
    """Give a page the session of who looks at it; None for the unknown, whom the page's script sends to sign in."""
    if known is None:
        yield None
        return
    with resources(request).database.transaction(known.fleet_id, read_only=True) as session:
        yield session


OpenResources = Annotated[Resources, Depends(resources)]
MaybePrincipal = Annotated[Principal | None, Depends(maybe_principal)]
CurrentPrincipal = Annotated[Principal, Depends(principal)]
ReadSession = Annotated[Session, Depends(_reading, scope="function")]
PageSession = Annotated[Session | None, Depends(page_session, scope="function")]
WriteSession = Annotated[Session, Depends(_writing, scope="function")]
