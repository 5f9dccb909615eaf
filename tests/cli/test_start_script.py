"""The start script in small checkouts of its own: locks without packages, so that no test asks the network."""

from __future__ import annotations

import os
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SHOW_CALL = """
import os, sys
import app
print(sys.argv[1:], os.path.dirname(os.path.dirname(app.__file__)), os.environ["NUMBA_CACHE_DIR"], sep="|")
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder with a space in its name, the real script and set-up, empty locks and a command that shows its call."""
    root = tmp_path / "a check out"
    (root / "app" / "cli").mkdir(parents=True)
    shutil.copy(ROOT / "ponthy", root / "ponthy")
    shutil.copy(ROOT / "app" / "cli" / "environment.py", root / "app" / "cli")
    (root / "app" / "__init__.py").touch()
    (root / "app" / "cli" / "__main__.py").write_text(SHOW_CALL)
    for lock in ("requirements.lock", "requirements-dev.lock"):
        (root / lock).write_text("# no packages\n")
    return root


def call(
    script: Path, *arguments: str, cwd: Path | None = None, path: str | None = None
) -> subprocess.CompletedProcess[str]:
    environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    environment["PATH"] = path or environment["PATH"]
    return subprocess.run([script, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, check=False)


def test_sets_up_once_and_runs_from_anywhere(checkout: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    (elsewhere / "app").mkdir(parents=True)
    (elsewhere / "app" / "__init__.py").write_text("raise ImportError('a stranger called app')")
    link = tmp_path / "link to ponthy"
    link.symlink_to(checkout / "ponthy")

    first = call(link, "decode", "a b", cwd=elsewhere)
    second = call(checkout / "ponthy", "decode", "a b", cwd=elsewhere)

    expected = f"['decode', 'a b']|{checkout}|{checkout}/.cache/numba\n"
    assert (first.returncode, first.stdout) == (0, expected), first.stderr
    assert (second.returncode, second.stdout, second.stderr) == (0, expected, "")
    assert "requirements.lock" in first.stderr
    assert "requirements-dev.lock" not in first.stderr


def test_two_calls_at_once_make_one_environment(checkout: Path) -> None:
    with ThreadPoolExecutor(3) as pool:
        done = list(pool.map(lambda _: call(checkout / "ponthy", "x"), range(3)))
    assert [one.returncode for one in done] == [0, 0, 0], [one.stderr for one in done]
    assert sum("installing" in one.stderr for one in done) == 1


def test_a_half_environment_is_made_again(checkout: Path) -> None:
    (checkout / ".venv" / "bin").mkdir(parents=True)
    (checkout / ".venv" / "bin" / "python").write_text("half written")
    (checkout / ".venv" / "left over").touch()
    assert call(checkout / "ponthy", "x").returncode == 0
    assert not (checkout / ".venv" / "left over").exists()


def test_a_failed_installation_is_not_taken_for_done(checkout: Path) -> None:
    (checkout / "requirements.lock").write_text("./nowhere/missing-1.0-py3-none-any.whl --hash=sha256:00\n")
    failed = call(checkout / "ponthy", "x")
    assert (failed.returncode, failed.stdout) == (1, "")
    assert "call again" in failed.stderr
    (checkout / "requirements.lock").write_text("# mended\n")
    assert call(checkout / "ponthy", "x").returncode == 0


def test_a_changed_lock_updates_and_a_moved_checkout_starts_afresh(checkout: Path) -> None:
    assert call(checkout / "ponthy", "x").returncode == 0
    (checkout / ".venv" / "kept").touch()
    (checkout / "requirements.lock").write_text("# newer\n")
    assert "installing" in call(checkout / "ponthy", "x").stderr
    assert (checkout / ".venv" / "kept").exists()

    moved = checkout.rename(checkout.with_name("moved"))
    after_move = call(moved / "ponthy", "x")
    assert f"|{moved}|" in after_move.stdout, after_move.stderr
    assert not (moved / ".venv" / "kept").exists()


def test_test_command_installs_the_development_lock_too(checkout: Path) -> None:
    done = call(checkout / "ponthy", "test")
    assert done.returncode == 0, done.stderr
    assert (checkout / ".venv" / "requirements-dev.lock.installed").exists()


def python_that(folder: Path, body: str) -> str:
    """Make a PATH whose only Python is a script, beside the few tools that the start script uses."""
    folder.mkdir()
    for tool in ("sh", "dirname", "readlink", "cat", "cmp"):
        found = shutil.which(tool)
        assert found is not None
        (folder / tool).symlink_to(found)
    python = folder / "python3"
    python.write_text(f"#!/bin/sh\n{body}\n")
    python.chmod(0o755)
    return str(folder)


@pytest.mark.parametrize(
    ("body", "advice"),
    [
        ("exit 1", "python3 is older than Python 3.11"),
        ('case "$2" in *ensurepip*) exit 1;; esac; exit 0', "apt install python3-venv"),
    ],
)
def test_says_what_python_is_missing(checkout: Path, tmp_path: Path, body: str, advice: str) -> None:
    done = call(checkout / "ponthy", "x", path=python_that(tmp_path / "bin", body))
    assert done.returncode == 1
    assert advice in done.stderr


def test_says_when_there_is_no_python(checkout: Path, tmp_path: Path) -> None:
    path = python_that(tmp_path / "bin", "")
    (tmp_path / "bin" / "python3").unlink()
    done = call(checkout / "ponthy", "x", path=path)
    assert done.returncode == 1
    assert "no Python found" in done.stderr
