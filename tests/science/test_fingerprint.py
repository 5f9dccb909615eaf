"""A kernel's cache is another one as soon as anything that it stands on has changed."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.science import fingerprint


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setattr(fingerprint, "ROOT", tmp_path)
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "kernels.py").write_text("from app.science.room.numbers import ONE\n")
    (tmp_path / "room" / "numbers.py").write_text("from app.science.units import (\n    METRE,\n)\n")
    (tmp_path / "units.py").write_text("METRE = 1\n")
    (tmp_path / "other.py").write_text("")
    fingerprint.kernels_fingerprint.cache_clear()
    yield tmp_path
    fingerprint.kernels_fingerprint.cache_clear()


@pytest.mark.parametrize(("changed", "another"), [("room/kernels.py", True), ("units.py", True), ("other.py", False)])
def test_it_follows_what_is_imported_and_nothing_else(root: Path, changed: str, another: bool) -> None:
    before = fingerprint.kernels_fingerprint("app.science.room.kernels")
    with (root / changed).open("a") as file:
        file.write("TWO = 2\n")
    fingerprint.kernels_fingerprint.cache_clear()
    assert (fingerprint.kernels_fingerprint("app.science.room.kernels") != before) is another


def test_two_rooms_have_two() -> None:
    rooms = ("app.science.observer.motion_filter", "app.science.logger.kernels")
    assert len({fingerprint.kernels_fingerprint(room) for room in rooms}) == 2
