"""`./ponthy up`: everything on this machine in one process tree, with one supervisor per data folder."""

from __future__ import annotations

import fcntl
import os
import signal
import socket
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

import structlog
from pydantic import SecretStr

import app.tables  # noqa: F401 - knows every table, so that the demo's job can refer to trips and cars
from app.accounts import service as accounts
from app.errors import PonthyError
from app.jobs import service as jobs
from app.observability import configure_logging
from app.settings import Settings
from app.storage.migrate import migrate
from app.storage.resources import Resources
from workers.children import Child

BEAT_S = 0.2
GRACE_S = 6.0

log = structlog.get_logger(__name__)


def run_up(settings: Settings, host: str, port: int, workers: int, demo: bool) -> int:
    """Run the web server and the workers until asked to stop.

    Parameters
    ----------
    settings : Settings
    host, port : str, int
        Where the web server listens; port 0 takes any free one.
    workers : int
        Number of worker processes.
    demo : bool
        Fill the fleet with virtual cars in the background.

    Returns
    -------
    int
        Exit status.

    Raises
    ------
    PonthyError
        When the data folder is in use by another Ponthy, or the address can't be had.
    """
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    with only_supervisor(settings.data_dir), _listening(host, port) as listener, _stop_signals() as stopping:
        chosen = settings.model_copy(update={"host": host, "port": listener.getsockname()[1]})
        configure_logging(chosen)
        prepare(chosen, demo)
        return _supervise(chosen, listener, workers, stopping)


def prepare(settings: Settings, demo: bool) -> None:
    """Bring the database up to date and give work that was under way when Ponthy ended to the workers to come."""
    migrate(settings)
    resources = Resources.open(settings)
    with resources.database.system_transaction() as session:
        freed = jobs.recover(session, settings.attempts, everything=settings.broker_url is None)
    if demo:
        with resources.database.transaction(accounts.DEFAULT_FLEET_ID) as session:
            jobs.create_demo_job(session, again=False)
    resources.close()
    if freed:
        log.info("work that was interrupted goes on", jobs=freed)


@contextmanager
def only_supervisor(data_dir: Path) -> Iterator[None]:
    """Hold the data folder's lock, which the system releases however the process ends."""
    with (data_dir / "up.lock").open("a+") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            message = f"Another Ponthy is running on {data_dir}. Stop it first, or give another folder with --data."
            raise PonthyError("already-running", message, 409) from None
        yield


def environment_of(settings: Settings) -> dict[str, str]:
    """Return the environment variables that give a child process these very settings."""
    cache = os.environ.get("NUMBA_CACHE_DIR") or str(settings.data_dir.resolve() / ".cache" / "numba")
    environment = {"NUMBA_CACHE_DIR": cache}
    for name in type(settings).model_fields:
        value = getattr(settings, name)
        if value is not None:
            text = value.get_secret_value() if isinstance(value, SecretStr) else str(value)
            environment[f"PONTHY_{name.upper()}"] = text
    return environment


def _supervise(settings: Settings, listener: socket.socket, workers: int, stopping: Callable[[], bool]) -> int:
    environment = environment_of(settings)
    web = Child("web", ["web", str(listener.fileno())], environment, [listener.fileno()])
    warming = Child("warm-up", ["warm"], environment)
    later = Child("warm-up of the other filters", ["warm", "filters"], environment)
    crew = [Child(f"worker {number + 1}", ["worker"], environment) for number in range(workers)]
    running = [web]
    web.start()
    warming.start()
    announced = False
    while not stopping():
        if crew and running == [web] and warming.status is not None:
            running += crew
            later.start()
        for child in running:
            child.keep_running()
        if not announced and _answers(settings):
            announced = True
            print(f"Ponthy is at {_address(settings)} (data in {settings.data_dir}); Ctrl-C ends it.", flush=True)
        time.sleep(BEAT_S)
    log.info("stopping")
    everyone = [warming, later, *running]
    for child in everyone:
        child.ask_to_stop()
    until = time.monotonic() + GRACE_S
    for child in everyone:
        child.stop(until)
    return 0


@contextmanager
def _listening(host: str, port: int) -> Iterator[socket.socket]:
    """Open the web server's socket here, so that a taken port is told at once and a restarted server loses nobody."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, port))
        except OSError as error:
            message = f"Can't listen on {host} port {port}: {error.strerror}. Give another one with --host or --port."
            raise PonthyError("address-not-available", message, 409) from error
        listener.listen(128)
        yield listener


@contextmanager
def _stop_signals() -> Iterator[Callable[[], bool]]:
    """Give a function that says whether SIGTERM or SIGINT came."""
    received: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        received.append(number)

    before = {number: signal.signal(number, note) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        yield lambda: bool(received)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _address(settings: Settings) -> str:
    host = "localhost" if settings.host in ("0.0.0.0", "::") else settings.host  # noqa: S104 - only compared
    return f"http://{f'[{host}]' if ':' in host else host}:{settings.port}"


def _answers(settings: Settings) -> bool:
    with suppress(OSError), urllib.request.urlopen(f"{_address(settings)}/health/live", timeout=1) as answer:  # noqa: S310
        return bool(answer.status == 200)
    return False
