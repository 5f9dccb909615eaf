"""Which science this is: hashes over its own source files."""

from functools import cache
from hashlib import sha256
from pathlib import Path

ROOT = Path(__file__).parent


@cache
def science_fingerprint() -> str:
    """Return 12 hexadecimal digits that change whenever any file of the science changes."""
    return _fingerprint(only_with=b"")


@cache
def kernels_fingerprint() -> str:
    """Return 12 hexadecimal digits that change whenever a file with compiled kernels changes."""
    return _fingerprint(only_with=b"app.science.jit import")


def _fingerprint(only_with: bytes) -> str:
    digest = sha256()
    for path in sorted(ROOT.rglob("*.py")):
        content = path.read_bytes()
        if only_with in content:
            digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + content + b"\0")
    return digest.hexdigest()[:12]
