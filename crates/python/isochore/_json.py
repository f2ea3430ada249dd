"""Conversion of Python data, including NumPy arrays, to JSON."""

import json
from collections.abc import Mapping

import numpy as np


def to_json(data):
    """Converts `data` to JSON. Raises ValueError if a number is not finite."""
    try:
        return json.dumps(data, default=_plain, allow_nan=False)
    except ValueError as error:
        raise ValueError(f"numbers in a recipe must be finite: {error}") from None


def _plain(value):
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"a recipe cannot contain a value of type {type(value).__name__}")
