"""Runs the tasks of a study on processes of this machine, or on any Dask cluster by its address."""

from __future__ import annotations

import asyncio
import logging
import signal
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib import import_module
from multiprocessing import resource_tracker
from typing import Any

from validate.comparison.examined import told_failure
from validate.errors import NotFinished, UsageError
from validate.extras import needed
from validate.plain_text import one_line, shown
from validate.studies.store import Store
from validate.studies.study import Row, Study, Task, differences, made_by

LOCAL = "local"
HERE = "127.0.0.1"  # local processes run what they are sent, so no other machine may reach them
ANSWER = 5.0  # time limit for the answer of a scheduler, s
FIRST_WORKER = 10.0  # time limit for the first worker of a cluster, s
WRITTEN = 2.0  # time between two files of results, s: the most that is lost if this process is killed
MOST = 5000  # largest number of Dask tasks of a run: a scheduler needs a millisecond for each
LOGGERS = ("distributed", "tornado", "asyncio")


def run(
    study: Study,
    tasks: Sequence[Task],
    store: Store,
    client: Any,
    recorded: Callable[[int], None] = lambda done: None,
) -> None:
    """Run tasks of a study and record their rows; finished tasks are recorded however the run ends.

    If a worker dies, another one runs the tasks that it was running.

    Args:
        recorded: called with the number of recorded tasks whenever it grows.
    Raises:
        UsageError: a worker runs another program, or several tasks at once.
        NotFinished: the scheduler is lost; a task kills one worker after the other, or raises an error; the
            records cannot be written.
    """
    distributed, size = quiet_dask(), -(-len(tasks) // MOST)
    chunks = [tuple(tasks[i : i + size]) for i in range(0, len(tasks), size)]
    held: list[Row] = []
    done, last = 0, time.monotonic()

    def record() -> None:
        nonlocal held, last
        if held:
            # Ctrl-C may come between any two steps: then the same rows are written again to the same file.
            store.write(held)
            held, last = [], time.monotonic()
        recorded(done)

    # pure=False, because otherwise a scheduler may return results of another run.
    futures = client.map(partial(_work_out, study.examine, made_by()), chunks, pure=False)
    try:
        for future in distributed.as_completed(futures, loop=client.loop):
            rows = _result(future)
            # Released, so that the task is not run again if the worker that keeps its result dies.
            future.release()
            held, done = [*held, *rows], done + len({(row["part"], row["number"]) for row in rows})
            if time.monotonic() - last >= WRITTEN:
                record()
    finally:
        record()


def _work_out(
    examine: Callable[[Task], list[Row]], program: Mapping[str, str], tasks: Sequence[Task]
) -> list[Row]:
    """The rows of some tasks, computed in the process of a worker by one thread."""
    worker = import_module("distributed").get_worker()
    if found := differences(made_by(), program):
        raise UsageError(
            f"the worker {worker.address} has other versions: {found}; install the same versions there"
        )
    if worker.state.nthreads != 1:
        # Threads would share global state without locks, such as the filter of warnings.
        raise UsageError(
            f"the worker {worker.address} runs {worker.state.nthreads} tasks at once, allowed: 1; start it "
            "with --nthreads 1"
        )
    return [row for task in tasks for row in rows_of(examine, task, worker.address)]


def rows_of(examine: Callable[[Task], list[Row]], task: Task, worker: str) -> list[Row]:
    """The rows of a task, computed in this process by one thread.

    Raises:
        UsageError: a package is missing. NotFinished: the task raised an error.
    """
    began = time.perf_counter()
    try:
        with import_module("threadpoolctl").threadpool_limits(1):
            rows = examine(task)
    except ImportError as error:
        raise UsageError(f"worker {worker}: {error}") from error
    except Exception as error:
        words = f"{type(error).__name__}: {told_failure(error)}"
        raise NotFinished(f"{task.part} {task.number}", words) from error
    every = {**task._asdict(), "seconds": time.perf_counter() - began, "worker": worker}
    return [{**every, **row} for row in rows]


def _result(future: Any) -> list[Row]:
    """The rows of a finished future; Dask computes them again if its worker has died since."""
    try:
        return list(future.result())
    except (UsageError, NotFinished):
        raise
    # Any error of Dask: the scheduler is lost, a task kills one worker after the other, or a worker lacks
    # this program.
    except Exception as error:
        message = one_line(f"{type(error).__name__}: {error}")
        raise NotFinished(
            "the cluster",
            f"has failed ({message}); each worker needs pip install 'pointcoord[validate,cluster]' of this "
            "version; the same command continues the study",
        ) from None


@contextmanager
def opened(address: str, workers: int | None = None) -> Iterator[Any]:
    """A Dask client of the cluster at an address, or, for `local`, of processes of this machine.

    Args:
        workers: number of local processes; if not given, the number of processors available to this process.
    Raises:
        MissingLibrary: Dask is not installed.
        UsageError: no scheduler answers, or there is no worker.
    """
    distributed = quiet_dask()
    if address == LOCAL:
        client = _local(distributed, workers)
    else:
        _require_scheduler(distributed, address)
        with warnings.catch_warnings():
            # Warnings of different versions: workers with different versions of what matters are refused
            # later.
            warnings.simplefilter("ignore")
            client = distributed.Client(address, set_as_default=False)
    try:
        try:
            client.wait_for_workers(1, timeout=FIRST_WORKER)
        except TimeoutError:
            where = shown(address)
            raise UsageError(
                f"the scheduler {where} has no worker after {FIRST_WORKER:g} s; start one: "
                f"dask worker {where} --nthreads 1"
            ) from None
        yield client
    finally:
        # Also if the cluster is lost.
        with suppress(Exception):
            client.close(timeout=ANSWER)


def quiet_dask() -> Any:
    """The package `distributed`, with its logging turned off: this program reports the errors.

    Raises:
        MissingLibrary: the package is not installed.
    """
    needed("study", "dask").config.set({"logging": dict.fromkeys(LOGGERS, "critical")})
    distributed = needed("study", "distributed")
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    return distributed


def _local(distributed: Any, workers: int | None) -> Any:
    """A client of its own local processes with one thread each; a process that dies is started again."""
    # A terminal sends Ctrl-C to all processes, but this program ends the workers. SIGINT is blocked here, so
    # that threads and processes started here never receive it. multiprocessing's resource tracker is started
    # before, because starting it would unblock the signal.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        return distributed.Client(
            set_as_default=False,
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host=HERE,
            # No dashboard; port 0, so that it does not take the port of another cluster's dashboard.
            dashboard_address=None,
            scheduler_kwargs={"dashboard": False, "dashboard_address": f"{HERE}:0"},
            memory_limit=0,
            silence_logs=logging.CRITICAL + 1,
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _require_scheduler(distributed: Any, address: str) -> None:
    """Check that a scheduler answers at an address; a Dask client of anything else would wait for ever.

    Raises:
        UsageError: no scheduler answers.
    """

    async def identity() -> Any:
        how = distributed.Security().get_connection_args("client")
        async with distributed.rpc(address, timeout=ANSWER, connection_args=how) as scheduler:
            return await scheduler.identity(n_workers=0)  # a worker does not accept this argument

    try:
        asyncio.run(asyncio.wait_for(identity(), ANSWER))
    except Exception as error:  # of any class: another program's answer may be read as a huge message size
        problem = one_line(str(error)) or f"no answer in {ANSWER:g} s"
        raise UsageError(
            f"the scheduler {shown(address)} does not answer as a Dask scheduler ({problem}); give "
            "--scheduler an address such as tcp://HOST:8786, where dask scheduler runs, or leave it out"
        ) from None
