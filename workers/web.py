"""What runs in the process of the web server. It loads no compiled kernel: those belong to the workers."""

from __future__ import annotations

import socket
import threading
from functools import partial

import uvicorn

from app import static_files
from app.main import create_app
from app.observability import configure_logging
from app.settings import Settings
from app.uploads import service as uploads
from workers.beats import UPLOADS_EVERY_S, Beat

SHUTDOWN_S = 3


def run_web(settings: Settings, listener: socket.socket | None = None) -> int:
    """Serve the pages and the API; on a socket that is open already, or on the settings' host and port."""
    configure_logging(settings)
    threading.Thread(target=static_files.make_ready, name="static files", daemon=True).start()
    app = create_app(settings)
    config = uvicorn.Config(
        app,
        host=settings.host,
        port=settings.port,
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=SHUTDOWN_S,
    )
    # Uploads are looked after here, because the files they are received in are on this machine.
    with Beat("uploads", UPLOADS_EVERY_S, partial(uploads.reap, app.state.resources)):
        uvicorn.Server(config).run(sockets=None if listener is None else [listener])
    return 0
