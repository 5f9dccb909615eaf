"""Two halves of the tests side by side: nothing said is lost, and the worse end counts."""

import sys
from pathlib import Path

import pytest

from app.cli.check import APART, ROOT, side_by_side

PROGRAM = """
import os, sys
print("heard", sys.argv[2], flush=True)
end = int(sys.argv[1])
if end < 0:
    os.kill(os.getpid(), -end)
sys.exit(end)
"""


@pytest.mark.parametrize(("ends", "status"), [((0, 0), 0), ((0, 1), 1), ((3, 1), 3), ((0, -9), 9)])
def test_the_worse_end_counts_and_both_are_heard(
    ends: tuple[int, int], status: int, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    first, second = ([sys.executable, "-c", PROGRAM, str(end), name] for end, name in zip(ends, "ab", strict=True))
    assert side_by_side(first, second) == status
    assert capfdbinary.readouterr().out == b"heard a\nheard b\n"


def test_what_stands_apart_is_there() -> None:
    assert all(Path(ROOT, folder).is_dir() for folder in APART)
