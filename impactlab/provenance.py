"""The provenance of datasets: versions, revision, time and processor."""

import os
import platform
import re
import subprocess
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path

_PACKAGES = "impactlab numpy numba xarray netCDF4 dask scipy"


def provenance() -> dict[str, str]:
    """Return where numbers come from: versions, source revision, time and class of processor."""
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        **_of_this_process(__file__),
        "Conventions": "CF-1.11",
    }


@cache  # what a process has loaded stays as it is
def _of_this_process(file: str) -> dict[str, str]:
    """Return versions, processor and revision of the source tree that holds `file`.

    The revision is a commit, marked if the tree has changes; "release" outside a checkout.
    """
    source = Path(file).resolve().parent
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES.split())
    info = Path("/proc/cpuinfo")
    model = re.search("^model name.*?: *(.*?) *$", info.read_text() if info.exists() else "", re.M)
    processor = model[1] if model else platform.processor() or platform.machine()
    command = ["git", "-C", str(source), "describe", "--always", "--dirty", "--abbrev=12"]
    revision = f"release {version('impactlab')}"
    if (source.parent / ".git").exists():
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
            revision = done.stdout.strip()
        except (OSError, subprocess.SubprocessError):
            revision = "unknown (git did not answer)"
    return {
        "versions": f"{packages}, python {platform.python_version()}",
        "source_revision": revision,
        "processor": f"{processor}, {os.cpu_count()} cores",
    }
