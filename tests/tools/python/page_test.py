"""docs/python.md: its blocks of Python run, one after the other.

    page_test.py docs/python.md
"""

import os
import re
import sys
import tempfile
from pathlib import Path

blocks = re.findall(r"```python\n(.*?)```", Path(sys.argv[1]).read_text(), re.DOTALL)
assert len(blocks) >= 5, f"found {len(blocks)} blocks"
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    names = {}
    for number, block in enumerate(blocks, 1):
        print(f"== block {number}")
        exec(compile(block, f"block {number}", "exec"), names)  # noqa: S102 - the page's own code
    assert names["distances"].max() > 1.9
    assert Path("found.simulation.xml").exists()
    os.chdir("/")
