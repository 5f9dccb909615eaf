"""``./ponthy user`` and ``./ponthy token``: who may use a service that asks for a login."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from app.cli.options import AsJson, Data, FleetName
from app.cli.output import say, table
from app.cli.service import fleet_session, opened

user = typer.Typer(help="People who may log in.")
token = typer.Typer(help="Tokens for scripts and fleet tools.")


@user.callback()
@token.callback()
def group() -> None:
    """Keep the name of the only command in a group part of the call."""


@user.command("add")
def add_user(
    email: Annotated[str, typer.Argument(help="E-mail address; the name to log in with.")],
    name: Annotated[str, typer.Option(help="Name that is shown.")] = "",
    fleet: FleetName = None,
    new_fleet: Annotated[str | None, typer.Option(help="Make a fleet of this name for the person.")] = None,
    password_stdin: Annotated[bool, typer.Option("--password-stdin", help="Read the password from input.")] = False,
    data: Data = None,
    as_json: AsJson = False,
) -> None:
    """Add a person.

    The password is asked for, or read from standard input.
    """
    from app.accounts import service as accounts

    password = sys.stdin.readline().rstrip("\n") if password_stdin else asked_password()
    if new_fleet is not None:
        with opened(data) as resources, resources.database.system_transaction() as session:
            fleet = accounts.add_fleet(session, new_fleet).id
    with fleet_session(data, fleet) as session:
        person = accounts.add_user(session, email, password, name)
        result = {"id": person.id, "email": person.email, "name": person.name, "fleet_id": person.fleet_id}
    say(result, as_json, f"{result['email']} may log in to fleet {result['fleet_id']}")


@token.command("create")
def create_token(
    name: Annotated[str, typer.Argument(help="What it is for.")],
    read_only: Annotated[bool, typer.Option("--read-only", help="It may read, and change nothing.")] = False,
    fleet: FleetName = None,
    data: Data = None,
    as_json: AsJson = False,
) -> None:
    """Make a token and print it; it is shown this once."""
    from app.accounts import service as accounts

    with fleet_session(data, fleet) as session:
        made, text = accounts.create_token(session, name, "read" if read_only else "write")
        result = {"id": made.id, "name": made.name, "scope": made.scope, "fleet_id": made.fleet_id, "token": text}
    say(result, as_json, text)


@token.command("list")
def list_tokens(fleet: FleetName = None, data: Data = None, as_json: AsJson = False) -> None:
    """List the newest tokens that are valid."""
    from app.accounts import service as accounts

    header = ["id", "name", "prefix", "scope"]
    with fleet_session(data, fleet) as session:
        rows = [{name: getattr(one, name) for name in header} for one in accounts.tokens(session, limit=200).items]
    say({"items": rows}, as_json, table([header, *([str(row[name]) for name in header] for row in rows)]))


@token.command("revoke")
def revoke_token(
    token_id: Annotated[str, typer.Argument(help="Identifier of the token.")],
    fleet: FleetName = None,
    data: Data = None,
) -> None:
    """Make a token useless from now on."""
    from app.accounts import service as accounts

    with fleet_session(data, fleet) as session:
        accounts.revoke_token(session, token_id)


def asked_password() -> str:
    """Ask for a password, twice, without showing it."""
    return str(typer.prompt("Password", hide_input=True, confirmation_prompt=True))
