"""pip builds and installs the package from a checkout, without a network; it then has its own copy of the scenarios.

    pip_test.py CHECKOUT
"""

import subprocess
import sys
import tempfile
from pathlib import Path

checkout = Path(sys.argv[1])
with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True)
    python = Path(folder) / "bin/python"
    subprocess.run([python, "-m", "pip", "install", "--no-index", "--no-build-isolation", checkout / "tools/python"], check=True)
    program = ("import proleg\n"
               "assert proleg.__version__.count('.') == 2, proleg.__version__\n"
               "for name in proleg.shipped(): proleg.Scenario(name)\n"
               "print(proleg.Scenario('caterpillar').file)\n"
               "print(proleg.simulate('caterpillar', 1, engine='reduced').displacement)\n")
    printed = subprocess.run([python, "-I", "-c", program], check=True, capture_output=True, text=True, cwd="/").stdout
    assert printed.startswith(folder), printed
    subprocess.run([python, "-m", "pip", "uninstall", "--yes", "proleg"], check=True)
    assert not list(Path(folder).glob("lib/*/site-packages/proleg*"))
