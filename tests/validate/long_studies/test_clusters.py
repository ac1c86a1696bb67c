"""Studies on Dask: whoever works out a number, it is worked out once and recorded whole."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas
import pyarrow.dataset
import pytest
from counted_study import CountedStudy
from program import ENVIRONMENT, PROGRAM
from worked_out import without_who_and_how_long, worked_out

from validate.cli import main
from validate.long_studies import run as study_run
from validate.long_studies import scheduler
from validate.long_studies.bounds import BoundsStudy
from validate.long_studies.errors import ClusterLost, NoCluster
from validate.long_studies.hard_runs import HardStudy
from validate.long_studies.maker import Maker
from validate.long_studies.records import Head, Records, adding_to, in_order, look
from validate.long_studies.run import run
from validate.long_studies.study import Number


def cluster_of(**options: Any) -> Any:
    distributed = scheduler.quiet_dask()
    pages = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}
    more = {"dashboard_address": None, "scheduler_kwargs": pages, "silence_logs": 100}
    return distributed.LocalCluster(host="127.0.0.1", protocol="tcp://", **more, **options)


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Of a cluster that this program did not start."""
    with cluster_of(n_workers=1, threads_per_worker=1, processes=True) as cluster:
        yield cluster.scheduler_address


def test_a_worker_killed_in_the_middle_loses_and_repeats_nothing_that_was_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study_run, "WRITTEN", 0.3)
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")
    study = CountedStudy(60, str(tmp_path / "marks"), pause=0.05)
    folder, before = tmp_path / "records", dict[Path, bytes]()
    with (
        adding_to(folder, Head.of(study)) as records,
        scheduler.opened("local", 2) as cluster,
    ):
        pids = cluster.client.run(os.getpid)
        assert len(set(pids.values())) == 2

        def tell(done: int) -> None:
            if done and not before:
                time.sleep(0.5)  # until the scheduler knows that these are handed over
                os.kill(next(iter(pids.values())), signal.SIGKILL)
                before.update({file: file.read_bytes() for file in records.files()})
                # Others can read what is there while the rest is worked out.
                assert pyarrow.dataset.dataset(str(folder)).to_table().num_rows == done
                assert len(pandas.read_parquet(folder)) == done < 60

        run(study, study.numbers, records, cluster, tell)
        rows = in_order(records.rows(), study.numbers)
        parts = pyarrow.dataset.dataset(str(folder)).to_table().to_pylist()
    assert [row["square"] for row in rows] == [number**2 for number in range(60)]
    assert len(parts) == 60, "nothing is recorded twice"
    early = {row["number"] for row in parts[: sum(len(pandas.read_parquet(file)) for file in before)]}
    begun = study.begun()
    assert early
    assert all(begun.count(number) == 1 for number in early), "what was recorded is not worked out again"
    assert {file: file.read_bytes() for file in before} == before
    assert {row["threads"] for row in rows} == {1}
    assert {row["told"] for row in rows} == {"1"}
    assert os.environ["OPENBLAS_NUM_THREADS"] == "4"
    # The killed worker's numbers of the time, done by others.
    assert len({row["worker"] for row in rows}) >= 2


def test_a_number_is_the_same_wherever_it_is_worked_out(
    address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cases = ["minus-infinity", "link-twice"]
    words = ["study", "hard", *cases, "--records", str(tmp_path)]
    assert main([*words, "--scheduler", address, "--json", "-"]) == 0
    out, err = capsys.readouterr()
    assert err.splitlines()[0].endswith("; a study that is stopped goes on with the same command")
    assert main(["hard", *cases, "--json", "-"]) == 0
    there, here = (json.loads(text)["cases"] for text in (out, capsys.readouterr().out))
    assert [{**case, "seconds": None} for case in there] == [{**case, "seconds": None} for case in here]
    study = HardStudy(("link-twice",))
    rows = in_order(look(tmp_path).rows(), study.numbers)
    assert without_who_and_how_long(rows) == without_who_and_how_long(worked_out(study))
    # Nobody is asked for what is recorded.
    assert main([*words, "--scheduler", "tcp://127.0.0.1:1"]) == 0
    assert "All as expected" in capsys.readouterr().out


def test_a_worker_of_another_version_is_refused(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = Maker.here()
    other = Maker(mine.program, {**mine.packages, "numpy": "1.0"})
    monkeypatch.setattr(Maker, "here", classmethod(lambda cls: other))
    folder = tmp_path / "records"
    assert main(["study", "random", "--scheduler", address, "--records", str(folder), "--count", "2"]) == 2
    *_, line = capsys.readouterr().err.splitlines()
    assert line.startswith("pointcoord: the worker tcp://127.0.0.1:")
    assert f"runs something else: numpy {mine.packages['numpy']}, here 1.0; install the same there" in line
    # One that joins later is refused when it hands in its first numbers, which are not recorded.
    study = CountedStudy(2, str(tmp_path / "marks"))
    monkeypatch.setattr(scheduler, "_workers", lambda client, words: [])
    with (
        scheduler.opened(address) as cluster,
        adding_to(folder, Head.of(study)) as records,
        pytest.raises(NoCluster, match="runs something else"),
    ):
        run(study, study.numbers, records, cluster)
    assert not records.files()


def test_a_worker_of_several_tasks_is_refused() -> None:
    with (
        cluster_of(n_workers=1, threads_per_worker=2, processes=False) as cluster,
        pytest.raises(NoCluster, match=r"takes 2 tasks at once.* --nthreads 1"),
        _opened(cluster),
    ):
        pass


def test_a_cluster_without_workers_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scheduler, "FIRST_WORKER", 0.2)
    with (
        cluster_of(n_workers=0, processes=False) as cluster,
        pytest.raises(NoCluster, match=r"has no worker after .* dask worker .* --nthreads 1"),
        _opened(cluster),
    ):
        pass


def _opened(cluster: Any) -> Any:
    return scheduler.opened(cluster.scheduler_address)


def test_a_task_that_ends_its_workers_is_named_with_the_last_of_them() -> None:
    killed = scheduler.quiet_dask().KilledWorker("t", SimpleNamespace(address="tcp://far:1"), 3)

    class Fatal:
        key = "random-1a-7"

        def result(self, timeout: float) -> None:
            raise killed

    with pytest.raises(ClusterLost, match=r"random-1a-7 ended 4 workers .*, the last of them tcp://far:1;"):
        scheduler.result_of(Fatal(), "the scheduler there", lambda: True)


def test_ctrl_c_just_when_a_file_is_written_records_nothing_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = CountedStudy(4, str(tmp_path / "marks"))
    monkeypatch.setattr(study_run, "WRITTEN", 0.0)

    class Here(scheduler.Cluster):
        def done(self, study: Any, tasks: Any) -> Iterator[scheduler.Done]:
            worker = scheduler.Worker("here", 1, Maker.here())
            for task in tasks:
                yield scheduler.Done(tuple(task), tuple(scheduler.rows_of(study, task, "here")), worker)

    class Interrupted(Records):
        def write(self, file: Path, rows: Any) -> None:
            super().write(file, rows)
            monkeypatch.setattr(Interrupted, "write", Records.write)
            raise KeyboardInterrupt

    told: list[int] = []
    with adding_to(tmp_path / "records", Head.of(study)) as records:
        records = Interrupted(records.folder, records.head)
        with pytest.raises(KeyboardInterrupt):
            run(study, study.numbers, records, Here(None, "here", 1), told.append)
    assert [row["number"] for row in pandas.read_parquet(records.folder).to_dict("records")] == [0, 1]
    assert told[-1] == 2


def test_a_scheduler_that_goes_away_leaves_what_is_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scheduler, "GONE", 1.0)
    monkeypatch.setattr(study_run, "WRITTEN", 0.1)
    study = CountedStudy(40, str(tmp_path / "marks"), pause=0.05)
    with cluster_of(n_workers=1, threads_per_worker=1, processes=False) as gone:

        def tell(done: int) -> None:
            if done:
                gone.close()

        with (
            adding_to(tmp_path / "records", Head.of(study)) as records,
            _opened(gone) as cluster,
            pytest.raises(ClusterLost, match="does not answer any more; the same command goes on"),
        ):
            run(study, study.numbers, records, cluster, tell)
    recorded = records.recorded()
    assert 0 < len(recorded) < 40
    assert len(recorded) == len(records.rows())


@pytest.mark.parametrize("listening", [False, True])
def test_an_address_that_does_not_answer_is_said_in_a_line(
    listening: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(scheduler, "ANSWER", 1.0)
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        port = server.getsockname()[1]
        if not listening:
            server.close()
        began = time.monotonic()
        words = ["study", "random", "--count", "2", "--records", str(tmp_path / "records")]
        assert main([*words, "--scheduler", f"tcp://127.0.0.1:{port}"]) == 2
    took = time.monotonic() - began
    assert took < 20.0
    # One line, and no word of a study that goes on: there is none.
    said = capsys.readouterr().err.splitlines()
    (line,) = [line for line in said if ": note: after " not in line]
    assert f"the scheduler tcp://127.0.0.1:{port} does not answer as a Dask scheduler (" in line
    (seconds,) = re.findall(r", after (\d+\.\d) s\); give --scheduler an address", line)
    assert float(seconds) <= took + 0.05
    assert "Error" not in line
    assert not (tmp_path / "records").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--workers", "0"], "--workers 0: allowed: 1 or more"),
        (["--workers", "2", "--scheduler", "tcp://h:1"], "leave one of them out"),
        (["--scheduler", "nonsense"], "does not answer as a Dask scheduler"),
        (["--scheduler", ""], "allowed: local, or an address"),
        (["--count", "0"], "no scene is asked for"),
        (["--count", "-1"], "--count -1: allowed: 0 or more"),
        (["--records", " "], "names no folder"),
        (["--from-records", "--count", "3"], "leave --count out"),
        (["--from-records", "--records", "nowhere"], "holds no records of a study"),
        (["--first", "absolute"], "invalid choice: 'absolute'"),
    ],
)
def test_a_mistake_of_the_command_line_is_one_line(
    words: list[str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(scheduler, "ANSWER", 1.0)
    assert main(["study", "random", *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    (line,) = [line for line in err.splitlines() if ": note: " not in line]
    assert told in line


def test_a_case_that_is_not_there_is_a_mistake_with_near_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["study", "hard", "at-rests"]) == 2
    assert "near names: at-rest" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("package", ["distributed", "pyarrow.parquet"])
def test_without_the_extra_one_line_names_it(
    package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    folder = tmp_path / "records"
    assert main(["study", "random", "--count", "2", "--records", str(folder)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"'study' needs the package '{package}'" in line
    assert "pip install 'pointcoord[cluster]'" in line
    assert not folder.exists()


def test_an_end_at_any_moment_leaves_records_whole_and_the_same_command_goes_on(tmp_path: Path) -> None:
    words = ["study", "bounds", "--poses", "400", "--motions", "0", "--workers", "1", "--records", "kept"]
    folder, seen = tmp_path / "kept", dict[Path, bytes]()
    for end in (signal.SIGINT, signal.SIGKILL):
        process = subprocess.Popen(
            [*PROGRAM, *words],
            cwd=tmp_path,
            env=ENVIRONMENT,
            start_new_session=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        while process.poll() is None and len(list(folder.glob("*.parquet"))) == len(seen):
            time.sleep(0.01)
        assert process.poll() is None, process.communicate()
        # All of it, workers included, as a terminal does and as when a machine goes down.
        os.killpg(process.pid, end)
        out, err = process.communicate(timeout=60)
        assert {file: file.read_bytes() for file in seen} == seen
        seen = {file: file.read_bytes() for file in look(folder).files()}
        count = len(look(folder).recorded())
        assert 0 < count < 400
        if end == signal.SIGINT:
            assert process.returncode == 130
            # Before it may stand how far the study was.
            *_, line = err.splitlines()
            assert (
                line == f"pointcoord: interrupted; kept holds {count} of 400 poses; the same command goes on"
            )
            assert out == ""
    # How many are asked for may change: some more than there are.
    last = count + 8
    words[words.index("400")] = str(last)
    assert main([*words[:-1], str(folder), "--quiet"]) == 0
    assert {file: file.read_bytes() for file in seen} == seen
    table = pandas.read_parquet(folder)
    assert len(set(table["number"])) == len(table), "nothing is recorded twice"
    assert set(range(last)) <= set(table["number"])
    some = [Number("held", number) for number in range(0, last, last // 5)]
    study = BoundsStudy(400, 0)
    here = [row for number in some for row in scheduler.rows_of(study, [number], "here")]
    found = without_who_and_how_long(in_order(look(folder).rows(), some))
    assert found == without_who_and_how_long(here)
