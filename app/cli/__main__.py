"""``python -m app.cli``, which is what ``./ponthy`` runs."""

import os
import sys

from app.cli.main import main

# A process for each core does the work, and the matrices are small: threads of a matrix library would only wait for
# each other, on a busy machine for seconds.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.exit(main())
