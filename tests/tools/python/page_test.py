"""docs/python.md: its blocks of Python run, one after the other, and again.

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
    for time in ("first", "second"):  # in a notebook, and in the folder of the first time
        names = {}
        for number, block in enumerate(blocks, 1):
            print(f"== block {number}, the {time} time")
            exec(compile(block, f"block {number}", "exec"), names)  # noqa: S102 - the page's own code
            exec(compile(block, f"block {number}", "exec"), names)  # noqa: S102
        assert names["distances"].max() > 1.9
    assert Path("found.simulation.xml").exists()
    os.chdir("/")
