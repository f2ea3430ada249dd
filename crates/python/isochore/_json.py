"""Plain data as JSON, with NumPy arrays in the place of lists."""

import json
from collections.abc import Mapping

import numpy as np


def to_json(data):
    """The text of `data`. Infinite numbers and those that are none have no place in it: ValueError."""
    try:
        return json.dumps(data, default=_plain, allow_nan=False)
    except ValueError as problem:
        raise ValueError(f"the numbers of a recipe must be finite: {problem}") from None


def _plain(value):
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"a recipe has no place for a {type(value).__name__}")
