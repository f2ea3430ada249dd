from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from distributed import Client

def run(
    recipe: str | PathLike[str],
    targets: Iterable[str | PathLike[str]],
    folder: str | PathLike[str],
    *,
    client: Client,
    format: str = "ply",
    settings: Mapping[str, Any] | Iterable[str] = (),
) -> Iterator[tuple[Path, dict[str, Any] | BaseException]]:
    """Deforms each mesh file of `targets` by a recipe and writes the results to `folder`.

    Each file replaces the target that the recipe names. The result of `scans/a.obj` is
    `folder/a.ply`, with its report next to it.

    format: extension of the results.
    settings: override keys of the recipe: {"refine.volume": 1e-5}.

    Yields pairs of a target and its report, in order of completion. If a target failed, the
    exception takes the position of the report.

    Raises ValueError if two results would have the same name, or if a result would overwrite a
    target or the recipe.
    """
