"""Names of a user's own from files."""

import subprocess
import sys
from pathlib import Path

CODE = """
from scenarios.names import find_creep_law
import sys
find_creep_law(sys.argv[1])
print(next(name for name in sys.modules if name.startswith("railslide_user")))
"""


def test_a_users_module_has_one_name_in_every_process() -> None:
    """So that an object which one process has pickled is found by another."""
    law = Path(__file__).parents[1] / "wheel_rail" / "user_laws.py"
    found = {
        subprocess.run(
            [sys.executable, "-c", CODE, f"{law}:circular"], check=True, capture_output=True, text=True
        ).stdout
        for _ in range(2)
    }
    assert len(found) == 1
