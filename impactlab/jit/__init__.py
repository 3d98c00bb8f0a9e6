"""Functions compiled by numba and kept on disk."""

import os

try:
    import numba as _numba  # noqa: F401  (here first, so that its refusal names the setting)
except ValueError as _error:
    _settings = sorted(f"{k}={v}" for k, v in os.environ.items() if k.startswith("NUMBA_"))
    if not _settings:
        raise
    raise ValueError(
        f"numba refuses a setting of the environment ({', '.join(_settings)}): {_error} "
        "Correct or unset it."
    ) from None
