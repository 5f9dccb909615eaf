"""``./ponthy up``, ``web``, ``worker`` and ``warm``: the processes of the service."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from app.cli.options import Data
from app.cli.service import become, chosen_settings

Host = Annotated[str | None, typer.Option(help="Address to listen on; off loopback people have to log in.")]
Port = Annotated[int | None, typer.Option(min=0, max=65535, help="Port to listen on; 0 takes a free one.")]


def up(
    host: Host = None,
    port: Port = None,
    data: Data = None,
    workers: Annotated[int | None, typer.Option(min=0, max=256, help="Worker processes.")] = None,
    demo: Annotated[bool, typer.Option("--demo", help="Fill the fleet with virtual cars in the background.")] = False,
) -> None:
    """Start everything on this machine.

    Web server and workers run in one process tree; Ctrl-C ends it in order.
    """
    choose(host=host, port=port, workers=workers)
    chosen_settings(data)
    become("up", *(["--demo"] if demo else []))


def web(host: Host = None, port: Port = None, data: Data = None) -> None:
    """Start a web server alone.

    For a service whose workers run elsewhere. The database is brought up to date first.
    """
    choose(host=host, port=port)
    chosen_settings(data)
    become("web")


def worker(data: Data = None) -> None:
    """Start one worker alone."""
    chosen_settings(data)
    become("worker")


def warm() -> None:
    """Compile all kernels into the cache now."""
    become("warm")


def choose(**options: str | int | None) -> None:
    """Let options of the call stand for the settings of the same name, in this process and those it starts."""
    for name, value in options.items():
        if value is not None:
            os.environ[f"PONTHY_{name.upper()}"] = str(value)
