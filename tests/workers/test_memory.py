"""A web server gives back the memory of what it has shown."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = """
import re, threading
from pathlib import Path
from workers.memory import give_back_memory

give_back_memory()
import numpy as np
import pyarrow as pa


def resident_mb():
    return int(re.search(r"VmRSS:\\s+(\\d+)", Path("/proc/self/status").read_text())[1]) / 1024


def read_columns():
    for _ in range(20):
        kept = [pa.array(np.ones(150_000 + 2000 * k)).cast("float32") for k in range(60)]
        del kept


before = resident_mb()
threads = [threading.Thread(target=read_columns) for _ in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(pa.default_memory_pool().backend_name, round(resident_mb() - before))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only glibc can be told")
def test_what_eight_threads_held_for_a_moment_is_given_back() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, check=True)
    pool, grown_mb = done.stdout.split()
    assert pool == "system"
    assert int(grown_mb) < 100
