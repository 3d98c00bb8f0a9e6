"""A dask cluster of Slurm jobs, from a profile."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from impactlab.study.declaration.messages import problems
from impactlab.study.declaration.reading import read_mapping, read_text
from impactlab.study.errors import StudyError

if TYPE_CHECKING:
    from dask_jobqueue.slurm import SLURMCluster


class Profile(BaseModel):
    """What a job asks of Slurm: the keys of dask_jobqueue.SLURMCluster, and the number of jobs."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    jobs: Annotated[int, Field(ge=1)]
    """How many are submitted; the study is solved by those that have started."""
    interface: str
    """The network on which this machine and the jobs see each other, such as ib0."""
    cores: Annotated[int, Field(ge=1)]
    processes: Annotated[int, Field(ge=1)] = 1
    """A job's cores are shared out among so many."""
    memory: str
    walltime: str
    queue: str | None = None
    account: str | None = None
    job_extra_directives: list[str] = []
    job_script_prologue: list[str] = []
    log_directory: str | None = None
    python: str | None = None
    """The interpreter on the nodes; that of this process where it is left out."""


def read_profile(path: Path) -> Profile:
    """The profile in a YAML file. Raises StudyError, naming file and key."""
    data = read_mapping(read_text(path), str(path))
    try:
        return Profile.model_validate(data)
    except ValidationError as error:
        keys = {id(data): list(Profile.model_fields)}
        raise StudyError(*problems(error, data, str(path), keys)) from None


def slurm_cluster(profile: Profile) -> SLURMCluster:
    """The cluster, its scheduler in this process, no job submitted yet.

    Raises OSError where dask-jobqueue or Slurm is not there.
    """
    try:
        from dask_jobqueue.slurm import SLURMCluster
    except ImportError:
        raise OSError("dask-jobqueue is not installed: pip install 'impactlab[slurm]'") from None
    if not shutil.which("sbatch"):
        raise OSError("there is no command sbatch here: start this where Slurm jobs are submitted")
    return SLURMCluster(
        n_workers=0,
        scheduler_options={"dashboard_address": "127.0.0.1:0"},
        **profile.model_dump(exclude={"jobs"}, exclude_none=True),
    )
