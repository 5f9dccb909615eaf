"""Which science this is: hashes over its own source files."""

import re
from collections.abc import Iterable
from functools import cache
from hashlib import sha256
from pathlib import Path

ROOT = Path(__file__).parent
IMPORT = re.compile(r"^from app\.science\.([\w.]+) import", re.MULTILINE)


@cache
def science_fingerprint() -> str:
    """Return 12 hexadecimal digits that change whenever any file of the science changes."""
    return _fingerprint(ROOT.rglob("*.py"))


@cache
def kernels_fingerprint(module: str) -> str:
    """Return 12 hexadecimal digits that change whenever a module of science changes, or one that it imports.

    Parameters
    ----------
    module : str
        Its dotted name.
    """
    found: set[Path] = set()
    waiting = [module.removeprefix("app.science.")]
    while waiting:
        path = ROOT.joinpath(*waiting.pop().split("."))
        path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        if path not in found and path.is_file():
            found.add(path)
            waiting += IMPORT.findall(path.read_text(encoding="utf-8"))
    return _fingerprint(found)


def _fingerprint(paths: Iterable[Path]) -> str:
    digest = sha256()
    for path in sorted(paths):
        digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:12]
