"""Tests that take long: `cargo xtask test --all` runs them, the gate does not."""

from __future__ import annotations

import os

import pytest

long = pytest.mark.skipif("PHIHAT_ALL" not in os.environ, reason="takes long: PHIHAT_ALL=1 runs it")
