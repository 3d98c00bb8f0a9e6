"""A study on schedulers and workers of their own: the same bits as in threads."""

import os
import subprocess
from contextlib import ExitStack

import pytest
import xarray as xr
from cluster import Cluster
from command_line import done
from command_line import process as impactlab

STUDY = """
title: Spread
impact: {base: paper}
discretisation: {nodes: 41, points: 3}
duration: 1 ms
sampling:
  method: grid
  parameters:
    velocity: {start: 1 m/s, stop: 2 m/s, number: 200}
responses: [peak_force, impulse]
"""
SBATCH = """#!/bin/sh
script=$(cat "$1")  # it is removed as soon as it is submitted
setsid sh -c "$script" >/dev/null 2>&1 &
echo "Submitted batch job $!"
"""
BRIDGE = "impactlab0"
NETWORK = "10.213.47"


def new_study(folder):
    (folder / "studies").mkdir()
    (folder / "studies" / "spread.yaml").write_text(STUDY)
    return folder


@pytest.fixture
def folder(tmp_path):
    return new_study(tmp_path)


@pytest.fixture(scope="module")
def in_threads(tmp_path_factory):
    """The runs, solved in threads of this process."""
    folder = new_study(tmp_path_factory.mktemp("threads"))
    done("run", "studies/spread.yaml", cwd=folder)
    return xr.load_dataset(folder / "results" / "spread" / "runs.nc").drop_attrs()


def solved(folder, *options, env=None):
    ended = impactlab("run", "studies/spread.yaml", *options, cwd=folder, env=env)
    assert ended.returncode == 0, ended.stderr
    assert "200 runs, 0 of them solved before" in ended.stderr
    runs = folder / "results" / "spread" / "runs.nc"
    return xr.load_dataset(runs).drop_attrs()


@pytest.fixture
def namespaces():
    """Three network namespaces behind a bridge; their names."""
    names = [f"impactlab{at}" for at in (1, 2, 3)]
    with ExitStack() as undone:

        def ip(*words):
            done = subprocess.run(["ip", *words], capture_output=True, text=True)
            if done.returncode:
                pytest.skip(f"network namespaces are not permitted here: {done.stderr.strip()}")

        def ip_later(*words):
            undone.callback(subprocess.run, ["ip", *words], capture_output=True)

        ip("link", "add", BRIDGE, "type", "bridge")
        ip_later("link", "delete", BRIDGE)
        ip("address", "add", f"{NETWORK}.254/24", "dev", BRIDGE)
        ip("link", "set", BRIDGE, "up")
        for at, name in enumerate(names, start=1):
            ip("netns", "add", name)
            ip_later("netns", "delete", name)
            ip("link", "add", f"il{at}", "type", "veth", "peer", "eth0", "netns", name)
            ip("link", "set", f"il{at}", "master", BRIDGE, "up")
            inside = ("-n", name)
            ip(*inside, "address", "add", f"{NETWORK}.{at}/24", "dev", "eth0")
            ip(*inside, "link", "set", "eth0", "up")
            ip(*inside, "link", "set", "lo", "up")
        yield names


@pytest.mark.long
def test_three_workers_in_networks_of_their_own(folder, namespaces, in_threads):
    with Cluster(folder, f"{NETWORK}.254") as cluster:
        for name in namespaces:
            cluster.add(inside=("ip", "netns", "exec", name))
        assert solved(folder, "--scheduler", cluster.address).identical(in_threads)


@pytest.fixture
def tls(tmp_path):
    """The environment with which dask asks for certificates, made for this test."""
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1"]
    command += ["-subj", "/CN=127.0.0.1", "-keyout", str(key), "-out", str(certificate)]
    try:
        subprocess.run(command, check=True, capture_output=True)
    except OSError:
        pytest.skip("there is no command openssl")
    settings = {"REQUIRE_ENCRYPTION": "True", "TLS__CA_FILE": str(certificate)}
    for who in ("SCHEDULER", "WORKER", "CLIENT"):
        settings |= {f"TLS__{who}__KEY": str(key), f"TLS__{who}__CERT": str(certificate)}
    return {f"DASK_DISTRIBUTED__COMM__{name}": value for name, value in settings.items()}


@pytest.mark.long
def test_certificates_of_dask_are_asked_for(folder, in_threads, tls):
    with Cluster(folder, protocol="tls", **tls) as cluster:
        cluster.add()
        to_it = ("--scheduler", cluster.address)
        refused = impactlab("run", "studies/spread.yaml", *to_it, cwd=folder)
        assert refused.returncode == 1
        assert "Traceback" not in refused.stderr
        assert solved(folder, *to_it, env=os.environ | tls).identical(in_threads)


def test_slurm_jobs_as_a_shell_would_run_them(folder, in_threads):
    """The whole path but Slurm itself: sbatch runs the job script here."""
    pytest.importorskip("dask_jobqueue")
    bin_folder = folder / "bin"
    bin_folder.mkdir()
    (bin_folder / "sbatch").write_text(SBATCH)
    (bin_folder / "scancel").write_text('#!/bin/sh\nfor job; do kill -- "-$job"; done\n')
    for file in bin_folder.iterdir():
        file.chmod(0o755)
    (folder / "workers.yaml").write_text(
        "{jobs: 2, interface: lo, cores: 1, memory: 1 GB, walltime: '00:05:00'}"
    )
    env = os.environ | {"PATH": f"{bin_folder}:{os.environ['PATH']}"}
    assert solved(folder, "--cluster", "workers.yaml", env=env).identical(in_threads)
