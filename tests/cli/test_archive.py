"""Backups: whole ones come back byte for byte, everything else is refused."""

from __future__ import annotations

import sqlite3
import tarfile
from contextlib import closing
from io import BytesIO
from pathlib import Path

import pytest

from app.cli.archive import read_archive, sqlite_file, write_archive
from app.errors import PonthyError
from app.settings import Settings
from app.storage.blobs import Blobs

FILES = {"fleets/a/uploads/1": bytes(range(256)) * 1000, "fleets/b/trips/2/k/states.parquet": b"", "x": b"y"}


def settings_of(folder: Path) -> Settings:
    return Settings(data_dir=folder)


def blobs_of(settings: Settings) -> Blobs:
    return Blobs(settings.blob_dir)


@pytest.fixture
def service(tmp_path: Path) -> Settings:
    settings = settings_of(tmp_path / "data")
    for key, content in FILES.items():
        blobs_of(settings).put(key, content)
    with closing(sqlite3.connect(sqlite_file(settings))) as database:
        database.execute("PRAGMA journal_mode=WAL")
        database.execute("CREATE TABLE trips (id INTEGER PRIMARY KEY, name TEXT)")
        database.executemany("INSERT INTO trips (name) VALUES (?)", [(f"trip {i}",) for i in range(500)])
        database.commit()
    return settings


def test_comes_back_as_it_was_while_others_write(service: Settings, tmp_path: Path) -> None:
    archive = tmp_path / "backup.tar"
    with closing(sqlite3.connect(sqlite_file(service))) as writer:
        writer.execute("INSERT INTO trips (name) VALUES ('not committed')")
        manifest = write_archive(service, blobs_of(service), archive)
        writer.rollback()
    assert (manifest["files"], manifest["file_bytes"]) == (3, sum(map(len, FILES.values())))

    other = settings_of(tmp_path / "other")
    read_archive(other, blobs_of(other), archive)

    assert {key: blobs_of(other).get(key) for key in blobs_of(other).keys("")} == FILES
    with closing(sqlite3.connect(sqlite_file(other))) as database:
        assert database.execute("SELECT count(*), max(name) FROM trips").fetchone() == (500, "trip 99")
    assert not [path for path in tmp_path.iterdir() if "ponthy-backup" in path.name]


def test_never_writes_over_what_is_there(service: Settings, tmp_path: Path) -> None:
    archive = tmp_path / "backup.tar"
    write_archive(service, blobs_of(service), archive)
    with pytest.raises(PonthyError, match="exists already"):
        write_archive(service, blobs_of(service), archive)
    with pytest.raises(PonthyError, match="empty data folder"):
        read_archive(service, blobs_of(service), archive)


@pytest.mark.parametrize("kept", [0.3, 0.9, 0.999])
def test_a_cut_archive_is_refused_and_leaves_no_database(service: Settings, tmp_path: Path, kept: float) -> None:
    archive = tmp_path / "backup.tar"
    write_archive(service, blobs_of(service), archive)
    with tarfile.open(archive) as tar:
        end = max(entry.offset_data + entry.size for entry in tar)
    cut = tmp_path / "cut.tar"
    cut.write_bytes(archive.read_bytes()[: int(end * kept)])
    other = settings_of(tmp_path / "other")
    with pytest.raises(PonthyError, match="not a whole"):
        read_archive(other, blobs_of(other), cut)
    assert not sqlite_file(other).exists()


def test_a_file_that_would_land_outside_is_refused(service: Settings, tmp_path: Path) -> None:
    archive = tmp_path / "bad.tar"
    with tarfile.open(archive, "w") as tar:
        entry = tarfile.TarInfo("files/../../outside")
        entry.size = 1
        tar.addfile(entry, BytesIO(b"x"))
    other = settings_of(tmp_path / "deep" / "other")
    with pytest.raises(PonthyError, match="land outside"):
        read_archive(other, blobs_of(other), archive)
    assert not list(tmp_path.rglob("outside"))


def test_says_where_no_data_is_and_whose_tools_postgresql_needs(tmp_path: Path) -> None:
    empty = settings_of(tmp_path / "nothing")
    with pytest.raises(PonthyError, match="There is no Ponthy data"):
        write_archive(empty, blobs_of(empty), tmp_path / "backup.tar")
    assert not (tmp_path / "backup.tar").exists()
    elsewhere = Settings(data_dir=tmp_path, database_url="postgresql://ponthy@db/ponthy")
    with pytest.raises(PonthyError, match="pg_dump"):
        write_archive(elsewhere, blobs_of(elsewhere), tmp_path / "backup.tar")
