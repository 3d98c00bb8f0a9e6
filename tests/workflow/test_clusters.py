"""A study on schedulers and workers of their own: the same bits as in threads."""

import os
import re
import subprocess
import sys
import time
from contextlib import ExitStack

import pytest
import xarray as xr

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


def impactlab(*args, cwd, env=None):
    command = [sys.executable, "-m", "impactlab", *args]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120, env=env)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "spread.yaml").write_text(STUDY)
    return tmp_path


@pytest.fixture
def started():
    """Starts processes, and ends them."""
    with ExitStack() as all_of_them:

        def start(*command, env=None):
            process = subprocess.Popen(
                command, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            all_of_them.callback(process.wait)
            all_of_them.callback(process.kill)
            return process

        yield start


@pytest.fixture
def scheduler(started, tmp_path):
    """Starts a scheduler that listens on a host, and returns its address."""

    def start(host, protocol="tcp", env=None):
        file = tmp_path / "scheduler.json"
        options = ["--host", host, "--port", "0", "--protocol", protocol]
        options += ["--dashboard-address", f"{host}:0", "--scheduler-file", str(file)]
        started(sys.executable, "-m", "distributed.cli.dask_scheduler", *options, env=env)
        deadline = time.monotonic() + 60
        while not file.exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.2)
        return re.search(rf"{protocol}://[\d.]+:\d+", file.read_text())[0]

    return start


def worker(address):
    options = ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
    return sys.executable, "-m", "distributed.cli.dask_worker", address, *options


def solved(folder, *options, env=None):
    done = impactlab("run", "studies/spread.yaml", *options, cwd=folder, env=env)
    assert done.returncode == 0, done.stderr
    assert "200 runs, 0 of them solved before" in done.stderr
    runs = folder / "results" / "spread" / "runs.nc"
    dataset = xr.load_dataset(runs).drop_attrs()
    (folder / "results").rename(folder / f"results_{time.monotonic_ns()}")
    return dataset


def test_three_workers_on_loopback(folder, scheduler, started):
    address = scheduler("127.0.0.1")
    for _ in range(3):
        started(*worker(address))
    assert solved(folder, "--scheduler", address).identical(solved(folder))


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


def test_three_workers_in_networks_of_their_own(folder, scheduler, started, namespaces):
    address = scheduler(f"{NETWORK}.254")
    for name in namespaces:
        started("ip", "netns", "exec", name, *worker(address))
    assert solved(folder, "--scheduler", address).identical(solved(folder))


@pytest.fixture
def tls(tmp_path):
    """An environment in which dask asks for certificates, made for this test."""
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
    return os.environ | {f"DASK_DISTRIBUTED__COMM__{name}": v for name, v in settings.items()}


def test_certificates_of_dask_are_asked_for(folder, scheduler, started, tls):
    address = scheduler("127.0.0.1", protocol="tls", env=tls)
    started(*worker(address), env=tls)
    refused = impactlab("run", "studies/spread.yaml", "--scheduler", address, cwd=folder)
    assert refused.returncode == 1
    assert "Traceback" not in refused.stderr
    assert solved(folder, "--scheduler", address, env=tls).sizes["velocity"] == 200


def test_slurm_jobs_as_a_shell_would_run_them(folder):
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
    assert solved(folder, "--cluster", "workers.yaml", env=env).identical(solved(folder))
