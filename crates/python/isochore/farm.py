"""Deforms many meshes by one recipe on a Dask cluster that is there already (`pip install isochore[farm]`).

>>> from dask.distributed import Client                         # doctest: +SKIP
>>> from isochore import farm                                   # doctest: +SKIP
>>> with Client("tcp://head:8786") as client:                   # doctest: +SKIP
...     for target, outcome in farm.run("press.toml", sorted(scans.glob("*.ply")), "pressed", client=client):
...         print(target, outcome)

Recipe, targets and results lie in folders that all workers see under the same path. Each mesh is one task; the cluster gives the
tasks of a worker that dies to others. A result is written whole or not at all, the mesh first and then its report, so that what is
finished stays finished: started again with the same files, settings and version, a run does only what is missing.
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
    places = [folder / f"{target.stem}.{format}" for target in targets]
    of_place = dict(zip(places, targets))
    if len(of_place) < len(targets):
        other = next(target for target, place in zip(targets, places) if of_place[place] != target)
        raise ValueError(f"{other}: another target has the same name")
    if not set(places).isdisjoint([*targets, recipe]):
        raise ValueError(f"{folder}: results would take the place of what they are made from")
    # Impure: whether there is anything to do, the worker finds out from the files.
    deform = functools.partial(client.submit, _deform, recipe, settings=_setting_texts(settings), pure=False)
    tasks = {deform(target, place): target for place, target in of_place.items()}
    for task in as_completed(tasks):
        yield tasks[task], task.exception() or task.result()


def _deform(recipe, target, place, *, settings):
    """One task: the report, made now or found from an earlier run."""
    settings = [*settings, f"target.mesh={json.dumps(str(target))}"]
    origin = _origin(recipe, settings)
    account = place.with_name(place.name + ".json")
    if place.exists() and account.exists():
        done = json.loads(account.read_text(encoding="utf-8"))
        # A worker may have died after it wrote another mesh, and before its report.
        if done["origin"] == origin and done["mesh"] == _sha256(place):
            return done["report"]
    result = _run(recipe, settings=settings)
    account.unlink(missing_ok=True)
    result.mesh.write(place)
    done = {"origin": origin, "mesh": _sha256(place), "report": result.report}
    _write_whole(account, json.dumps(done, indent=2))
    return result.report


def _origin(recipe, settings):
    """What a result is made of: the version, the settings, and the SHA-256 of the recipe and of all files that it needs."""
    loaded, folder = _parse(recipe, settings)
    names = {*loaded.mesh_names, *loaded.curve_names, *filter(None, [loaded.weights_name])}
    named = [folder / name for name in sorted(names)]
    # What is missing, the run itself complains of.
    needed = [path for path in [recipe, *named, *(part for path in named for part in _parts(path))] if path.is_file()]
    return {
        "version": importlib.metadata.version("isochore"),
        "settings": settings,
        "files": {str(path): _sha256(path) for path in needed},
    }


def _parts(path):
    """Buffers and images that a glTF file names; none where it cannot be read, which the run itself complains of."""
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


def _write_whole(path, text):
    # Not a file of `tempfile`, which nobody else may read.
    draft = path.with_name(f".isochore-{uuid.uuid4().hex}")
    try:
        draft.write_text(text, encoding="utf-8")
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)
