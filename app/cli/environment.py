"""Makes the virtual environment from the hashed locks. ``./ponthy`` runs it with any Python: standard library only."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import time
import venv
from pathlib import Path


def expected_mark(root: Path, lock: str) -> str:
    """Return what the mark of an installed lock must say: the folder, the Python and the lock itself.

    Raises
    ------
    OSError, subprocess.CalledProcessError
        When there is no working Python in the environment, or no such lock.
    """
    python = root / ".venv" / "bin" / "python"
    version = subprocess.run([python, "-V"], check=True, capture_output=True, text=True).stdout  # noqa: S603 - our venv
    return f"{root}\n{version}{(root / lock).read_text()}"


def mark_path(root: Path, lock: str) -> Path:
    """Return the file that says that a lock is installed."""
    return root / ".venv" / f"{lock}.installed"


def is_installed(root: Path, lock: str) -> bool:
    """Say whether this very lock was installed completely, here and with this Python."""
    try:
        return mark_path(root, lock).read_text() == expected_mark(root, lock)
    except (OSError, subprocess.CalledProcessError):
        return False


def fits(root: Path, lock: str) -> bool:
    """Say whether the environment was complete once and is of this folder and Python, so that it can be updated."""
    try:
        marked, expected = (
            text.splitlines()[:2] for text in (mark_path(root, lock).read_text(), expected_mark(root, lock))
        )
    except (OSError, subprocess.CalledProcessError):
        return False
    return marked == expected


def install(root: Path, lock: str) -> None:
    """Install a lock with its hashes and mark it as installed, in this order, so that a half one is never marked."""
    mark = mark_path(root, lock)
    mark.unlink(missing_ok=True)
    pip = [str(root / ".venv" / "bin" / "python"), "-P", "-m", "pip", "-qq", "--disable-pip-version-check"]
    # The lock is complete, so nothing is left to resolve; modules are compiled when first imported.
    options = ["--require-hashes", "--no-deps", "--no-compile", "--requirement", str(root / lock)]
    subprocess.run([*pip, "install", *options], check=True, env={**os.environ, "PIP_USER": "0"})  # noqa: S603 - our venv
    temporary = mark.with_suffix(".new")
    temporary.write_text(expected_mark(root, lock))
    temporary.replace(mark)


def set_up(root: Path, locks: list[str]) -> None:
    """Make or update the environment of a checkout; one process at a time, the others wait and find it done."""
    (root / ".cache").mkdir(exist_ok=True)
    with (root / ".cache" / "set-up.lock").open("w") as guard:
        fcntl.flock(guard, fcntl.LOCK_EX)  # released by the system, however the process ends
        missing = [lock for lock in locks if not is_installed(root, lock)]
        if not missing:
            return
        began = time.monotonic()
        print(f"ponthy: installing {', '.join(missing)} into .venv; this is done once", file=sys.stderr)
        if not fits(root, locks[0]):
            venv.create(root / ".venv", clear=True, symlinks=True, with_pip=True)
        for packages in (root / ".venv" / "lib").glob("python3*/site-packages"):
            (packages / "ponthy.pth").write_text(f"{root}\n")  # makes `app` and `workers` importable
        for lock in missing:
            install(root, lock)
        print(f"ponthy: ready after {time.monotonic() - began:.0f} s", file=sys.stderr)


def main() -> None:
    """Set up the checkout named by the first argument with the locks named by the others."""
    try:
        set_up(Path(sys.argv[1]), sys.argv[2:])
    except subprocess.CalledProcessError as error:
        sys.exit(f"ponthy: set-up failed at `{' '.join(map(str, error.cmd[2:6]))}` (see above); call again to retry")
    except OSError as error:
        sys.exit(f"ponthy: set-up failed: {error}; call again to retry")
    except KeyboardInterrupt:
        sys.exit("ponthy: set-up interrupted; call again to finish it")


if __name__ == "__main__":
    main()
