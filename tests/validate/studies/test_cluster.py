"""Studies on Dask: whoever works out a task, it is worked out once and recorded whole."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pandas
import pytest
from counted_study import counted, without_who_and_how_long, worked_out
from program import ENVIRONMENT

from validate.cli import main
from validate.errors import NotFinished, UsageError
from validate.studies import cluster
from validate.studies.hard_cases import hard
from validate.studies.store import records
from validate.studies.study import made_by


def cluster_of(threads_per_worker: int = 1, **options: Any) -> Any:
    distributed = cluster.quiet_dask()
    pages = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}
    more = {"dashboard_address": None, "scheduler_kwargs": pages, "silence_logs": 100, "protocol": "tcp://"}
    return distributed.LocalCluster(
        host="127.0.0.1", threads_per_worker=threads_per_worker, **(more | options)
    )


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Of a cluster that this program did not start."""
    with cluster_of(n_workers=1, processes=True) as other:
        yield other.scheduler_address


def test_a_worker_killed_in_the_middle_loses_and_repeats_nothing_that_was_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "WRITTEN", 0.3)
    study = counted(60, tmp_path / "marks", pause=0.05)
    before = dict[Path, bytes]()
    store = records(tmp_path / "records", study)
    with cluster.opened("local", 2) as client:
        pids = client.run(os.getpid)
        assert len(set(pids.values())) == 2

        def tell(done: int) -> None:
            if done and not before:
                time.sleep(0.5)  # until the scheduler knows that these are handed over
                os.kill(pids[next(iter(store.rows().values()))[0]["worker"]], signal.SIGKILL)
                before.update({file: file.read_bytes() for file in store.files()})
                # Others can read what is there while the rest is worked out.
                assert len(pandas.read_parquet(store.folder)) == done < 60

        cluster.run(study, study.tasks, store, client, tell)
        recorded = store.rows()
        rows = [row for task in study.tasks for row in recorded[task]]
    assert [row["square"] for row in rows] == [number**2 for number in range(60)]
    assert len(pandas.read_parquet(store.folder)) == 60, "nothing is recorded twice"
    early = {number for file in before for number in pandas.read_parquet(file)["number"]}
    begun = [int(line) for line in (tmp_path / "marks").read_text().split()]
    assert early
    assert all(begun.count(number) == 1 for number in early), "what was recorded is not worked out again"
    assert {file: file.read_bytes() for file in before} == before
    assert {row["threads"] for row in rows} == {1}
    # The killed worker's tasks of the time, done by others.
    assert len({row["worker"] for row in rows}) >= 2


def test_a_worker_of_another_version_records_nothing(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = dict(made_by())
    monkeypatch.setattr(cluster, "made_by", lambda: {**mine, "numpy": "1.0"})
    folder = tmp_path / "records"
    assert main(["study", "random", "--scheduler", address, "--records", str(folder), "--count", "2"]) == 2
    *_, line = capsys.readouterr().err.splitlines()
    assert line.startswith("pointcoord: the worker tcp://127.0.0.1:")
    assert f"has other versions: numpy {mine['numpy']}, here 1.0; install the same versions there" in line
    assert not folder.exists()


def ran(study: Any, folder: Path, address: str, told: Any = lambda done: None) -> None:
    with cluster.opened(address) as client:
        cluster.run(study, study.tasks, records(folder, study), client, told)


@pytest.mark.parametrize(
    ("workers", "threads", "words"),
    [
        (1, 2, r"runs 2 tasks at once.* --nthreads 1"),
        (0, 1, r"has no worker after .* dask worker .* --nthreads 1"),
    ],
)
def test_a_cluster_that_cannot_work_a_study_out_is_refused(
    workers: int, threads: int, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "FIRST_WORKER", 0.2)
    with (
        cluster_of(n_workers=workers, threads_per_worker=threads, processes=False) as other,
        pytest.raises(UsageError, match=words),
    ):
        ran(counted(2, tmp_path / "marks"), tmp_path / "records", other.scheduler_address)


def test_an_error_of_a_task_names_it_and_leaves_what_was_recorded(address: str, tmp_path: Path) -> None:
    study, folder = counted(6, tmp_path / "marks", wrong=5), tmp_path / "records"
    with pytest.raises(NotFinished, match=r"^all 5: ZeroDivisionError: no square at counted_study\.py:\d+; "):
        ran(study, folder, address)
    assert {task.number for task in records(folder, study).rows()} == {0, 1, 2, 3, 4}


def test_a_scheduler_that_goes_away_leaves_what_is_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "WRITTEN", 0.1)
    study = counted(40, tmp_path / "marks", pause=0.05)
    with cluster_of(n_workers=1, processes=False) as gone:

        def tell(done: int) -> None:
            if done:
                gone.close()

        with pytest.raises(NotFinished, match=r"has failed .* the same command continues"):
            ran(study, tmp_path / "records", gone.scheduler_address, tell)
    assert 0 < len(records(tmp_path / "records", study).rows()) < 40


def test_an_address_that_does_not_answer_is_said_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cluster, "ANSWER", 1.0)
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        port = server.getsockname()[1]
        words = ["study", "random", "--count", "2", "--records", str(tmp_path / "records")]
        assert main([*words, "--scheduler", f"tcp://127.0.0.1:{port}"]) == 2
    # One line, and no word of a study that goes on: there is none.
    said = capsys.readouterr().err.splitlines()
    (line,) = [line for line in said if ": note: after " not in line]
    assert f"the scheduler tcp://127.0.0.1:{port} does not answer as a Dask scheduler (" in line
    assert "Error" not in line
    assert not (tmp_path / "records").exists()


# The program, which writes its records more often.
OFTEN = """
import sys
from validate.studies import cluster
from pointcoord.__main__ import main
cluster.WRITTEN = 0.2
sys.exit(main())
"""


def test_an_end_at_any_moment_leaves_records_whole_and_the_same_command_goes_on(
    address: str, tmp_path: Path
) -> None:
    # So many that no machine is through with them, a tenth of a second each.
    names = ("at-rest", "slow-inputs", "fast-inputs", "kink-of-a-table", "come-to-rest", "far-in-time")
    more = ("start-from-rest", "close-times-of-a-table", "seen-at-rest-only", "phase-of-many-turns")
    words = ["study", "hard", *names, *more, "far-in-time-wishbone", "--workers", "1", "--records", "kept"]
    folder, study = tmp_path / "kept", hard(words[2:-4])
    every = len(study.tasks)
    process = subprocess.Popen(
        [sys.executable, "-c", OFTEN, *words],
        cwd=tmp_path,
        env=ENVIRONMENT,
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while process.poll() is None and not list(folder.glob("*.parquet")):
        time.sleep(0.01)
    assert process.poll() is None, process.communicate()
    # All of it, workers included, as a terminal does.
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    seen = {file: file.read_bytes() for file in records(folder, study).files()}
    count = len(records(folder, study).rows())
    assert 0 < count < every
    # Before it may stand how far the study was.
    *_, line = err.splitlines()
    assert (
        line == f"pointcoord: interrupted; kept holds {count} of {every:,} scenes; the same command continues"
    )
    assert out == ""
    # What is asked for may change.
    few = hard(["far-in-time-wishbone"])
    again = ["study", "hard", "far-in-time-wishbone", "--scheduler", address, "--records", str(folder)]
    assert main([*again, "--quiet"]) == 0
    assert {file: file.read_bytes() for file in seen} == seen
    table = pandas.read_parquet(folder)
    assert len(table.drop_duplicates(["part", "number", "formulation"])) == len(table), "recorded twice"
    recorded = records(folder, few).rows()
    found = without_who_and_how_long([row for task in few.tasks for row in recorded[task]])
    assert found == without_who_and_how_long(worked_out(few))
