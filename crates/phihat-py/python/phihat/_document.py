"""Studies: a path, or a document."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._errors import ArgumentError

Study = str | os.PathLike[str] | Mapping[str, Any]
"""A study: the path of its file, or its document as nested dictionaries with the keys of docs/study.md.

In a document numbers, sequences and NumPy arrays serve alike, and files are relative to the working directory.
"""


def source(study: Study) -> tuple[str | None, str | None]:
    """Path or JSON text, whichever a study is."""
    if isinstance(study, Mapping):
        return None, json.dumps(study, default=_plain)
    if isinstance(study, (str, os.PathLike)):
        return os.fspath(study), None
    kind = type(study).__name__
    limit = "a path or a dictionary"
    raise ArgumentError(f"study: {kind}; it must be {limit}", field="study", value=study, limit=limit)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    kind = type(value).__name__
    raise ArgumentError(f"study: a value of type {kind}; a study holds tables, lists, numbers, strings")
