"""Session and tokens over REST."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app import __version__
from app.accounts import schemas, service
from app.edge import CurrentPrincipal, OpenResources, ReadSession, WriteSession
from app.errors import PonthyError
from app.jobs import service as jobs
from app.schemas import Cursor, Id, Limit, Listing
from app.security import SESSION_COOKIE, Principal
from app.settings import Settings
from app.storage.paging import DEFAULT_LIMIT

router = APIRouter(tags=["accounts"])


@router.get("/session")
def show_session(session: ReadSession, resources: OpenResources, who: CurrentPrincipal) -> schemas.SessionDocument:
    """Say who is here, and what this Ponthy is."""
    settings = resources.settings
    user = service.signed_in_user(session, who.user_id)
    tiles = {"url": settings.tiles_url, "attribution": settings.tiles_attribution} if settings.tiles_url else None
    return schemas.SessionDocument.model_validate(
        {
            "mode": "loopback" if settings.is_loopback else "authenticated",
            "fleet": service.own_fleet(session),
            "user": user,
            "version": __version__,
            "code_version": settings.code_version,
            "demo": {"available": True, "job_id": jobs.demo_job_id(session)},
            "tiles": tiles,
        }
    )


@router.post("/session", status_code=204)
def log_in(credentials: schemas.Credentials, request: Request, resources: OpenResources) -> Response:
    """Log in; the answer sets the session's cookie."""
    client = "" if request.client is None else request.client.host
    _user, secret = service.log_in(resources, credentials.email, credentials.password, client)
    return _with_cookie(secret, request, resources.settings)


def _with_cookie(secret: str, request: Request, settings: Settings) -> Response:
    answer = Response(status_code=204)
    https = request.url.scheme == "https" or (settings.public_url or "").startswith("https://")
    lifetime_s = int(settings.session_hours * 3600)
    answer.set_cookie(SESSION_COOKIE, secret, max_age=lifetime_s, httponly=True, samesite="strict", secure=https)
    return answer


@router.delete("/session", status_code=204)
def log_out(request: Request, resources: OpenResources) -> Response:
    """Log out; without a session this does nothing."""
    cookie = request.cookies.get(SESSION_COOKIE)
    if cookie:
        service.log_out(resources.database, cookie)
    answer = Response(status_code=204)
    answer.delete_cookie(SESSION_COOKIE, httponly=True, samesite="strict")
    return answer


def _by_a_person(who: Principal) -> None:
    if who.means == "token":
        message = "Tokens are made and revoked by a person who has logged in, not with another token."
        raise PonthyError("forbidden", message, 403)


@router.get("/tokens")
def list_tokens(
    session: ReadSession, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[schemas.TokenDocument]:
    """List the tokens that are in force."""
    return Listing[schemas.TokenDocument].model_validate(service.tokens(session, cursor, limit))


@router.post("/tokens", status_code=201)
def create_token(body: schemas.TokenRequest, session: WriteSession, who: CurrentPrincipal) -> schemas.NewTokenDocument:
    """Make a token; its text is in this answer and nowhere else."""
    _by_a_person(who)
    token, text = service.create_token(session, body.name, body.scope)
    plain = schemas.TokenDocument.model_validate(token)
    return schemas.NewTokenDocument(**plain.model_dump(), token=text)


@router.delete("/tokens/{token_id}", status_code=204)
def revoke_token(token_id: Id, session: WriteSession, who: CurrentPrincipal) -> None:
    """Make a token useless from now on."""
    _by_a_person(who)
    service.revoke_token(session, token_id)
