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
    """Deforms each mesh file of `targets`, in place of the recipe's own target, into `folder`.

    The result of `scans/a.obj` is `folder/a.ply`, in `format`, with its report beside it. Yields each target with its report, or with
    what went wrong, as they come in. settings: win over the
    recipe, {"refine.volume": 1e-5}.
    """
