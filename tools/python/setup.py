"""Builds the package with CMake, for pip (docs/python.md): `pip install --no-build-isolation ./tools/python` in a checkout."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

# Absolute, because pip may build in another folder.
SOURCE = Path(__file__).resolve().parents[2]
VERSION = re.search(r"project\(proleg VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text()).group(1)


class CMakeBuild(build_ext):
    """The modules are built in the checkout's build/pip, and lie with the shipped scenarios in the package, and with the player of recordings if it was built."""

    def build_extension(self, extension):
        build = SOURCE / "build/pip"
        package = Path(self.get_ext_fullpath(extension.name)).parent
        for command in (["cmake", "--preset", "programs", "-B", build, "-D", f"PROLEG_PYTHON={sys.executable}"],
                        ["cmake", "--build", build, "--target", "proleg_python"]):
            subprocess.run(command, cwd=SOURCE, check=True)
        package.mkdir(parents=True, exist_ok=True)
        for module in (build / "python/proleg").glob("_*.so"):
            shutil.copy(module, package)
        if (SOURCE / "build/player/player.html").exists():  # tools/page builds it
            (package / "player").mkdir(exist_ok=True)
            shutil.copy(SOURCE / "build/player/player.html", package / "player")
        shutil.copytree(SOURCE / "sim/scenarios", package / "scenarios", dirs_exist_ok=True)


setup(version=VERSION, ext_modules=[Extension("proleg._core", [])], cmdclass={"build_ext": CMakeBuild})
