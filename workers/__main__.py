"""``python -m workers …``: the processes that `./ponthy` and the supervisor start."""

from __future__ import annotations

import socket
import sys

from app.errors import PonthyError
from app.settings import Settings
from workers.children import die_with_parent
from workers.memory import give_back_memory


def main(arguments: list[str]) -> int:
    """Run what the first word names; with a file descriptor after ``web``, serve on that open socket."""
    die_with_parent()
    settings = Settings()
    match arguments:
        case ["up", *rest]:
            from workers.supervisor import run_up

            return run_up(settings, settings.host, settings.port, settings.workers, demo="--demo" in rest)
        case ["web"]:
            give_back_memory()
            from app.observability import configure_logging
            from app.storage.migrate import migrate
            from workers.web import run_web

            configure_logging(settings)
            migrate(settings)
            return run_web(settings)
        case ["web", descriptor]:  # the supervisor has migrated the database and opened the socket
            give_back_memory()
            from workers.web import run_web

            return run_web(settings, socket.socket(fileno=int(descriptor)))
        case ["worker"]:
            from workers.processes import run_worker

            return run_worker(settings)
        case ["warm"]:
            from workers.warming import warm

            return warm()
        case ["warm", "filters"]:
            from workers.warming import warm_filters

            return warm_filters()
        case _:
            print("usage: python -m workers up [--demo] | web [FD] | worker | warm [filters]", file=sys.stderr)
            return 2


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except PonthyError as error:
        sys.exit(f"ponthy: {error.message}")
