"""A Ponthy for tests, in two sizes: embedded (SQLite, a folder as queue) and server (PostgreSQL, Redis).

A test that takes `settings`, `resources` or `client` runs once in each size; the second is marked ``postgres`` and
skipped where the two servers are not installed.
"""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:  # the fixtures import what they need, so that tests of the science stay light
    from fastapi.testclient import TestClient

    from app.settings import Settings
    from app.storage.resources import Resources

BASE_URL = "http://127.0.0.1:8321"
TEMPLATE = "migrated"


def free_port() -> int:
    """Return a port that nobody listens on at the moment."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def postgres_programs() -> Path | None:
    """Return the folder of PostgreSQL's programs; Debian keeps them off the path."""
    on_path = shutil.which("pg_ctl")
    if on_path is not None:
        return Path(on_path).parent
    return next(iter(sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)), None)


@dataclass
class PostgresServer:
    """A PostgreSQL server of our own, on loopback, thrown away afterwards."""

    programs: Path
    folder: Path
    port: int

    def run(self, *command: str) -> None:
        """Run one of PostgreSQL's programs, which refuse to be root."""
        line = [str(self.programs / command[0]), *command[1:]]
        if os.getuid() == 0:
            line = ["su", "postgres", "-c", " ".join(f"'{word}'" for word in line)]
        subprocess.run(line, check=True, capture_output=True, cwd=self.folder)

    def url(self, database: str) -> str:
        return f"postgresql://postgres@127.0.0.1:{self.port}/{database}"

    def create(self, database: str, template: str) -> str:
        import psycopg

        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            connection.execute(f'CREATE DATABASE "{database}" TEMPLATE "{template}"')
        return self.url(database)


@pytest.fixture(scope="session")
def postgres_server() -> Iterator[PostgresServer]:
    """Start PostgreSQL, with a database that is migrated already to copy from."""
    programs = postgres_programs()
    if programs is None or shutil.which("redis-server") is None:
        pytest.skip("PostgreSQL and Redis are not installed (apt-get install postgresql redis-server)")
    folder = Path(tempfile.mkdtemp(prefix="ponthy-postgres-"))
    if os.getuid() == 0:
        shutil.chown(folder, "postgres", "postgres")
    server = PostgresServer(programs, folder, free_port())
    server.run("initdb", "-D", f"{folder}/data", "-U", "postgres", "-A", "trust", "--no-sync", "-E", "UTF8")
    options = f"-p {server.port} -c listen_addresses=127.0.0.1 -c unix_socket_directories={folder} -c fsync=off"
    server.run("pg_ctl", "-D", f"{folder}/data", "-w", "-l", f"{folder}/log", "-o", options, "start")
    try:
        from app.settings import Settings
        from app.storage.migrate import migrate

        migrate(Settings(data_dir=folder, database_url=server.create(TEMPLATE, "template0")))
        yield server
    finally:
        server.run("pg_ctl", "-D", f"{folder}/data", "-m", "immediate", "stop")
        shutil.rmtree(folder)


@pytest.fixture(scope="session")
def redis_url() -> Iterator[str]:
    """Start Redis, keeping nothing on disk."""
    program = shutil.which("redis-server")
    if program is None:
        pytest.skip("Redis is not installed (apt-get install redis-server)")
    port = free_port()
    folder = tempfile.mkdtemp(prefix="ponthy-redis-")
    line = [program, "--port", str(port), "--bind", "127.0.0.1", "--save", "", "--dir", folder]
    server = subprocess.Popen(line, stdout=subprocess.DEVNULL)
    try:
        wait_for_port(port)
        yield f"redis://127.0.0.1:{port}"
    finally:
        server.terminate()
        server.wait()
        shutil.rmtree(folder)


def wait_for_port(port: int, seconds: float = 20.0) -> None:
    """Return once something listens on a port."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1.0):
            return
        time.sleep(0.05)
    pytest.fail(f"nothing listens on port {port} after {seconds} s")


_numbers = count(1)


@pytest.fixture(params=["embedded", pytest.param("server", marks=pytest.mark.postgres)])
def settings(request: pytest.FixtureRequest, tmp_path: Path) -> Settings:
    """Return settings of a fresh Ponthy whose database is migrated."""
    from redis import Redis

    from app.settings import Settings
    from app.storage.migrate import migrate

    if request.param == "embedded":
        chosen = Settings(data_dir=tmp_path / "data")
        migrate(chosen)
        return chosen
    postgres: PostgresServer = request.getfixturevalue("postgres_server")
    redis: str = request.getfixturevalue("redis_url")
    number = next(_numbers)
    broker_url = f"{redis}/{number % 16}"
    Redis.from_url(broker_url).flushdb()  # an earlier test had this one of Redis' sixteen databases
    database_url = postgres.create(f"test{number}", TEMPLATE)
    return Settings(data_dir=tmp_path / "data", database_url=database_url, broker_url=broker_url)


@pytest.fixture
def resources(settings: Settings) -> Iterator[Resources]:
    """Open what a process of the service holds open."""
    from app.storage.resources import Resources

    opened = Resources.open(settings)
    yield opened
    opened.close()


@pytest.fixture
def client(settings: Settings) -> Iterator[TestClient]:
    """Return a browser on this machine; its `app` is the application."""
    from fastapi.testclient import TestClient

    from app.main import create_app

    with TestClient(create_app(settings), base_url=BASE_URL) as browser:
        yield browser


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """Return a folder on a real disk of 8 MB."""
    folder = tmp_path / "small"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("mounting a small disk is not allowed here")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)
