"""``python -m app.cli``, which is what ``./ponthy`` runs."""

import sys

from app.cli.main import main

sys.exit(main())
