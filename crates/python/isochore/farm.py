"""Deforms many meshes by one recipe on an existing Dask cluster (`pip install isochore[farm]`).

>>> from dask.distributed import Client                         # doctest: +SKIP
>>> from isochore import farm                                   # doctest: +SKIP
>>> with Client("tcp://head:8786") as client:                   # doctest: +SKIP
...     for target, outcome in farm.run("press.toml", sorted(scans.glob("*.ply")), "pressed", client=client):
...         print(target, outcome)

All workers must see the recipe, the targets and the results under the same paths. Each mesh is one
task. If a worker dies, the cluster assigns its tasks to other workers. Each result is written
atomically, the mesh first and then its report. A run that is repeated with the same files, settings
and version of isochore computes only the missing results.
"""

import functools
import hashlib
import importlib.metadata
import json
import os
import pathlib
import struct
import uuid
from urllib.parse import unquote

from isochore._recipe import parse as _parse
from isochore._recipe import run as _run
from isochore._recipe import setting_texts as _setting_texts

try:
    from distributed import as_completed
except ImportError as missing:
    raise ImportError("isochore.farm needs Dask: pip install isochore[farm]") from missing


def run(recipe, targets, folder, *, client, format="ply", settings=()):
    """Deforms every mesh file of `targets` by `recipe` into `folder`. See the type stubs for the arguments."""
    recipe = pathlib.Path(os.fspath(recipe)).resolve()
    folder = pathlib.Path(os.fspath(folder)).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    targets = [pathlib.Path(os.fspath(target)).resolve() for target in targets]
    outputs = [folder / f"{target.stem}.{format}" for target in targets]
    target_of = dict(zip(outputs, targets))
    if len(target_of) < len(targets):
        other = next(target for target, output in zip(targets, outputs) if target_of[output] != target)
        raise ValueError(f"{other}: another target has the same name, so their results would collide")
    if not set(outputs).isdisjoint([*targets, recipe]):
        raise ValueError(f"{folder}: results would overwrite the recipe or a target; choose another folder")
    # Impure: only the worker can find out from the files whether there is work to do.
    deform = functools.partial(client.submit, _deform, recipe, settings=_setting_texts(settings), pure=False)
    tasks = {deform(target, output): target for output, target in target_of.items()}
    for task in as_completed(tasks):
        yield tasks[task], task.exception() or task.result()


def _deform(recipe, target, output, *, settings):
    """Runs one task, or finds its result from an earlier run. Returns the report."""
    settings = [*settings, f"target.mesh={json.dumps(str(target))}"]
    origin = _origin(recipe, settings)
    report_file = output.with_name(output.name + ".json")
    if output.exists() and report_file.exists():
        done = json.loads(report_file.read_text(encoding="utf-8"))
        # A worker may have died between writing a new mesh and writing its report.
        if done["origin"] == origin and done["mesh"] == _sha256(output):
            return done["report"]
    result = _run(recipe, settings=settings)
    report_file.unlink(missing_ok=True)
    result.mesh.write(output)
    done = {"origin": origin, "mesh": _sha256(output), "report": result.report}
    _write_atomically(report_file, json.dumps(done, indent=2))
    return result.report


def _origin(recipe, settings):
    """Identifies the inputs of a result: version, settings, and SHA-256 of the recipe and its files."""
    loaded, folder = _parse(recipe, settings)
    named = [folder / name for name in loaded.file_names]
    # The run itself reports missing files.
    needed = [path for path in [recipe, *named, *(part for path in named for part in _parts(path))] if path.is_file()]
    return {
        "version": importlib.metadata.version("isochore"),
        "settings": settings,
        "files": {str(path): _sha256(path) for path in needed},
    }


def _parts(path):
    """Returns the buffers and images of a glTF file, or nothing if it is invalid, which the run reports."""
    if path.suffix.lower() not in (".gltf", ".glb") or not path.is_file():
        return []
    data = path.read_bytes()
    try:
        if data.startswith(b"glTF"):
            (length,) = struct.unpack_from("<I", data, 12)
            data = data[20 : 20 + length]
        document = json.loads(data)
        uris = [part["uri"] for kind in ("buffers", "images") for part in document.get(kind, []) if "uri" in part]
        return [path.parent / unquote(uri) for uri in uris if not uri.startswith("data:")]
    except (ValueError, TypeError, AttributeError, struct.error):
        return []


def _sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _write_atomically(path, text):
    # `tempfile` would create a file that only its owner can read.
    draft = path.with_name(f".isochore-{uuid.uuid4().hex}")
    try:
        draft.write_text(text, encoding="utf-8")
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)
