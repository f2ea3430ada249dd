"""Builds with maturin and adds the command `isochore` to the wheel."""

import json
import pathlib
import shutil
import subprocess
import sys

import maturin
from maturin import (  # noqa: F401  other hooks of a build backend
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
)

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "target" / "python" / "isochore.data" / "scripts"


def build_sdist(sdist_directory, config_settings=None):
    # maturin requires the folder even if it packages nothing from it.
    SCRIPTS.mkdir(parents=True, exist_ok=True)
    return maturin.build_sdist(sdist_directory, config_settings)


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    SCRIPTS.mkdir(parents=True, exist_ok=True)
    return maturin.prepare_metadata_for_build_wheel(metadata_directory, config_settings)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    _stage_command()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def _stage_command():
    """Compiles the command and copies it to the scripts folder that maturin packages."""
    subprocess.run(["cargo", "build", "--release", "--locked", "--package", "isochore-cli"], cwd=ROOT, check=True)
    metadata = subprocess.run(
        ["cargo", "metadata", "--no-deps", "--format-version", "1"], cwd=ROOT, check=True, capture_output=True
    )
    name = "isochore.exe" if sys.platform == "win32" else "isochore"
    SCRIPTS.mkdir(parents=True, exist_ok=True)
    shutil.copy(pathlib.Path(json.loads(metadata.stdout)["target_directory"]) / "release" / name, SCRIPTS / name)
