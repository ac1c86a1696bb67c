"""Who works out the tasks of a study: processes of this machine, or any Dask cluster by its address."""

from __future__ import annotations

import asyncio
import logging
import signal
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
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
HERE = "127.0.0.1"  # nobody else reaches processes of this machine: what they are sent, they run
ANSWER = 5.0  # seconds that a scheduler is given to answer
FIRST_WORKER = 10.0  # and a cluster to have a worker
WRITTEN = 2.0  # seconds of what is worked out that one file holds: what the end of this process can cost
MOST = 5000  # Dask tasks of a run: a scheduler needs a millisecond for each
LOGGERS = ("distributed", "tornado", "asyncio")


def run(
    study: Study,
    tasks: Sequence[Task],
    store: Store,
    client: Any,
    told: Callable[[int], None] = lambda done: None,
) -> None:
    """Work out tasks of a study and record them; whatever ends it, what was done before is recorded.

    A worker that dies costs the tasks that it was at: another one works them out.

    Args:
        told: how many of the tasks are recorded, whenever there are more.
    Raises:
        UsageError: a worker runs another program, or several tasks at once.
        NotFinished: the scheduler is gone; a task ends its workers one after the other, or raises an error;
            the records cannot be written.
    """
    distributed, size = quiet_dask(), max(study.chunk, -(-len(tasks) // MOST))
    chunks = [tuple(tasks[i : i + size]) for i in range(0, len(tasks), size)]
    held: list[Row] = []
    done, last = 0, time.monotonic()

    def record() -> None:
        nonlocal held, last
        if held:
            # Ctrl-C may come between any two steps: the same rows are then written again to the same file.
            store.write(held)
            held, last = [], time.monotonic()
        told(done)

    # Not pure: a scheduler gives what it still has of another run otherwise.
    futures = client.map(partial(_work_out, study.examine, made_by()), chunks, pure=False)
    try:
        for future in distributed.as_completed(futures, loop=client.loop):
            rows = _result(future)
            # What is handed over is not to be worked out again when the worker that still has it dies.
            future.release()
            held, done = [*held, *rows], done + len({(row["part"], row["number"]) for row in rows})
            if time.monotonic() - last >= WRITTEN:
                record()
    finally:
        record()


def _work_out(
    examine: Callable[[Task], list[Row]], program: Mapping[str, str], tasks: Sequence[Task]
) -> list[Row]:
    """The rows of some tasks, worked out in the process of a worker by one thread."""
    worker = import_module("distributed").get_worker()
    if told := differences(made_by(), program):
        raise UsageError(f"the worker {worker.address} runs something else: {told}; install the same there")
    if worker.state.nthreads != 1:
        # What tasks share, such as the filter of warnings, they would share unguarded.
        raise UsageError(
            f"the worker {worker.address} takes {worker.state.nthreads} tasks at once, a study takes workers "
            "of one; start it with --nthreads 1"
        )
    return [row for task in tasks for row in rows_of(examine, task, worker.address)]


def rows_of(examine: Callable[[Task], list[Row]], task: Task, worker: str) -> list[Row]:
    """The rows of a task, worked out here by one thread.

    Raises:
        UsageError: a package is not there. NotFinished: the task raised an error.
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
    """What came of a future that is finished; it is worked out again if its worker has died since."""
    try:
        return list(future.result())
    except (UsageError, NotFinished):
        raise
    # Whatever Dask says: of a scheduler that is gone, a task that ended its workers one after the other, or a
    # worker that has no such program.
    except Exception as error:
        said = one_line(f"{type(error).__name__}: {error}")
        raise NotFinished(
            "the cluster",
            f"it does not work any more ({said}); each worker needs pip install "
            "'pointcoord[validate,cluster]', of this version; the same command goes on",
        ) from None


@contextmanager
def opened(address: str, workers: int | None = None) -> Iterator[Any]:
    """Dask's client of the cluster at an address, or for `local` of processes of this machine.

    Args:
        workers: how many processes of this machine; as many as it has processors for us, if not given.
    Raises:
        MissingLibrary: Dask is not there.
        UsageError: nothing answers, or there is no worker.
    """
    distributed, cluster = quiet_dask(), address
    with ExitStack() as stack:
        if address == LOCAL:
            cluster = _local(distributed, workers)
            stack.callback(_quietly, cluster.close)
        else:
            _require_scheduler(distributed, address)
        with warnings.catch_warnings():
            # Of other versions; those that matter are refused.
            warnings.simplefilter("ignore")
            client = distributed.Client(cluster, set_as_default=False)
        stack.callback(_quietly, client.close)
        try:
            client.wait_for_workers(1, timeout=FIRST_WORKER)
        except TimeoutError:
            where = shown(address)
            raise UsageError(
                f"the scheduler {where} has no worker after {FIRST_WORKER:g} s; start one: "
                f"dask worker {where} --nthreads 1"
            ) from None
        yield client


def quiet_dask() -> Any:
    """The package `distributed`, which says nothing by itself: what matters is said by this program.

    Raises:
        MissingLibrary: it is not there.
    """
    needed("study", "dask", "cluster").config.set({"logging": dict.fromkeys(LOGGERS, "critical")})
    distributed = needed("study", "distributed", "cluster")
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    return distributed


def _local(distributed: Any, workers: int | None) -> Any:
    """Processes of this machine, one thread each; one that dies is started again."""
    # A terminal sends Ctrl-C to all; who ends the workers is this program. Threads and processes that begin
    # here, and theirs, never see it. Whoever starts the tracker of multiprocessing would hear again.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        return distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host=HERE,
            # No pages of its own; the port of those that any other cluster here may have is left alone.
            dashboard_address=None,
            scheduler_kwargs={"dashboard": False, "dashboard_address": f"{HERE}:0"},
            memory_limit=0,
            silence_logs=logging.CRITICAL + 1,
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _require_scheduler(distributed: Any, address: str) -> None:
    """See that a scheduler answers: a client of something else waits for ever.

    Raises:
        UsageError: none does.
    """

    async def identity() -> Any:
        how = distributed.Security().get_connection_args("client")
        async with distributed.rpc(address, timeout=ANSWER, connection_args=how) as scheduler:
            return await scheduler.identity(n_workers=0)  # a worker knows no such argument

    try:
        asyncio.run(asyncio.wait_for(identity(), ANSWER))
    except Exception as error:  # also of what another program says, taken for the size of an answer
        problem = one_line(str(error)) or f"no answer in {ANSWER:g} s"
        raise UsageError(
            f"the scheduler {shown(address)} does not answer as a Dask scheduler ({problem}); give "
            "--scheduler an address such as tcp://HOST:8786, where dask scheduler runs, or leave it out"
        ) from None


def _quietly(close: Callable[..., object]) -> None:
    """End a client or a cluster, also one that is gone."""
    with suppress(Exception):
        close(timeout=ANSWER)
