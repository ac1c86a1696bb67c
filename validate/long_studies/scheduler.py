"""Who works out the numbers of a study: processes of this machine, or any Dask cluster by its address."""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from multiprocessing import resource_tracker
from queue import Empty, SimpleQueue
from typing import Any

from validate.extras import MissingPackage
from validate.long_studies.errors import ClusterLost, NoCluster
from validate.long_studies.maker import Maker
from validate.long_studies.study import Number, Row, Study
from validate.plain_text import one_line, shown

LOCAL = "local"
ANSWER = 5.0  # seconds that a scheduler is given to answer
FIRST_WORKER = 10.0  # and a cluster to have a worker
START = 120.0  # and processes of this machine to start, beside whatever else it does
TICK = 0.5  # seconds between two looks at whether the scheduler is there
GONE = 20.0  # seconds that a lost scheduler is given to come back
# One task in a process: what tasks share, such as the filter of warnings, they would share unguarded.
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
ENVIRONMENT = {**dict.fromkeys(THREADS, "1"), "DASK_LOGGING__DISTRIBUTED": "critical"}
LOGGERS = ("distributed", "tornado", "asyncio")


@dataclass(frozen=True)
class Worker:
    """A process that works out numbers.

    Attributes:
        address: its own. tasks: how many it takes at once. maker: its program.
    """

    address: str
    tasks: int
    maker: Maker


@dataclass(frozen=True)
class Done:
    """Some numbers that are worked out, all their rows, and by whom."""

    numbers: tuple[Number, ...]
    rows: tuple[Row, ...]
    worker: Worker


def this_worker(dask_worker: Any = None) -> Worker:
    """The worker that runs this.

    Args:
        dask_worker: Dask's; given by Dask where this is no task.
    """
    worker = dask_worker or import_module("distributed").get_worker()
    return Worker(worker.address, worker.state.nthreads, Maker.here())


def work_out(study: Study, numbers: Sequence[Number]) -> Done:
    """Some numbers of a study, in the process of a worker."""
    worker = this_worker()
    return Done(tuple(numbers), tuple(rows_of(study, numbers, worker.address)), worker)


def rows_of(study: Study, numbers: Sequence[Number], worker: str) -> Iterator[Row]:
    """The rows of some numbers, worked out here by one thread."""
    limits = import_module("threadpoolctl").threadpool_limits
    with limits(1):
        for number in numbers:
            began = time.perf_counter()
            rows = study.examine(number)
            seconds = time.perf_counter() - began
            every = {**dict.fromkeys(study.columns), **number._asdict(), "seconds": seconds, "worker": worker}
            yield from ({**every, **row} for row in rows)


class Cluster:
    """A Dask cluster whose workers run this very program.

    Attributes:
        client: Dask's. words: what it is, for messages. workers: how many it had when it was opened.
    """

    def __init__(self, client: Any, words: str, workers: int) -> None:
        self.client = client
        self.words = words
        self.workers = workers

    def done(self, study: Study, tasks: Sequence[Sequence[Number]]) -> Iterator[Done | None]:
        """The numbers of a study, worked out in any order; None now and then, where nothing new is done.

        A worker that dies costs the tasks that it was at: another one works them out.

        Raises:
            NoCluster: a worker runs another program, or several tasks at once.
            ClusterLost: the scheduler is gone, or a task ends its workers one after the other.
            Exception: what a task raised.
        """
        waiting: SimpleQueue[Any] = SimpleQueue()
        # Each run has keys of its own: a scheduler gives what it still has of another one's otherwise.
        run = os.urandom(4).hex()
        futures = {
            self.client.submit(work_out, study, tuple(task), key=f"{study.name}-{run}-{i}", pure=False)
            for i, task in enumerate(tasks)
        }
        for future in futures:
            future.add_done_callback(waiting.put)
        known: set[str] = set()
        lost: float | None = None
        try:
            while futures:
                try:
                    future = waiting.get(timeout=TICK)
                except Empty:
                    now = time.monotonic()
                    lost = None if self.client.status == "running" else lost or now
                    if lost is not None and now - lost > GONE:
                        raise ClusterLost(_gone(self.words)) from None
                    yield None
                    continue
                futures.discard(future)
                done = result_of(future, self.words, lambda: self.client.status == "running")
                # What is handed over is not to be worked out again when the worker that still has it dies.
                future.release()
                # Workers may join a cluster at any time.
                if done.worker.address not in known:
                    require_same(done.worker)
                    known.add(done.worker.address)
                yield done
        finally:
            with suppress(Exception):
                self.client.cancel(list(futures), force=True)


def result_of(future: Any, words: str, alive: Callable[[], bool]) -> Done:
    """What a task came to.

    Args:
        future: Dask's, which was done; it is worked out again if its worker has died since.
        words: what the cluster is. alive: whether it is there.
    Raises:
        ClusterLost: nothing, for the cluster is gone or the task ends its workers.
        Exception: what the task raised.
    """
    distributed = import_module("distributed")
    while True:
        try:
            done: Done = future.result(timeout=GONE)
            return done
        except distributed.KilledWorker as error:
            raise ClusterLost(
                f"{future.key} ended {error.allowed_failures + 1} workers one after the other, the last of "
                f"them {error.last_worker.address}; look into its log, and at its memory"
            ) from None
        except TimeoutError:
            if not alive():
                raise ClusterLost(_gone(words)) from None
        except distributed.CancelledError:
            raise ClusterLost(_gone(words)) from None


def _gone(words: str) -> str:
    return f"{words} does not answer any more; the same command goes on elsewhere"


def require_same(worker: Worker) -> None:
    """Refuse a worker that would work out something else.

    Raises:
        NoCluster: it does.
    """
    if differences := worker.maker.differences(Maker.here()):
        raise NoCluster(
            f"the worker {worker.address} runs something else: {'; '.join(differences)}; install the same "
            "there"
        )
    if worker.tasks != 1:
        raise NoCluster(
            f"the worker {worker.address} takes {worker.tasks} tasks at once, a study takes workers of one; "
            "start it with --nthreads 1"
        )


@contextmanager
def opened(address: str, workers: int | None = None) -> Iterator[Cluster]:
    """The cluster at an address, or for `local` one of processes of this machine, as long as the block is.

    Args:
        workers: how many processes of this machine; as many as it has processors for us, if not given.
    Raises:
        MissingPackage: Dask is not there.
        NoCluster: nothing answers, there is no worker, or one that would work out something else.
    """
    with ExitStack() as stack:
        distributed = quiet_dask()
        if address == LOCAL:
            count = workers or processors()
            cluster = stack.enter_context(_local(distributed, count))
            words, wanted, patience = "the scheduler of this machine's processes", count, START
        else:
            cluster, words, wanted, patience = address, f"the scheduler {shown(address)}", 1, FIRST_WORKER
            _require_scheduler(distributed, address, words)
        client = _client(distributed, cluster)
        stack.callback(_close, client)
        try:
            client.wait_for_workers(wanted, timeout=patience)
        except TimeoutError:
            if address == LOCAL:
                raise NoCluster(
                    f"{count} processes do not start within {START:g} s; try --workers 1"
                ) from None
            raise NoCluster(
                f"{words} has no worker after {FIRST_WORKER:g} s; start one: "
                f"dask worker {shown(address)} --nthreads 1"
            ) from None
        found = _workers(client, words)
        for worker in found:
            require_same(worker)
        yield Cluster(client, words, len(found))


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _workers(client: Any, words: str) -> list[Worker]:
    """All workers of now.

    Raises:
        NoCluster: one of them cannot run our program.
    """
    try:
        found: Mapping[str, Any] = client.run(this_worker, on_error="return")
    except Exception as error:
        found = {f"of {words}": error}
    for address, worker in found.items():
        if not isinstance(worker, Worker):
            told = one_line(f"{type(worker).__name__}: {worker}")
            raise NoCluster(
                f"the worker {address} cannot run this program ({told}); it needs "
                "pip install 'pointcoord[validate,cluster]', of this version"
            )
    return list(found.values())


def quiet_dask() -> Any:
    """The package `distributed`, which says nothing by itself: what matters is said by this program.

    Raises:
        MissingPackage: it is not there.
    """
    try:
        dask = import_module("dask")
        dask.config.set({"logging": dict.fromkeys(LOGGERS, "critical")})
        distributed = import_module("distributed")
    except ImportError as error:
        raise MissingPackage("study", error, "cluster") from None
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    return distributed


@contextmanager
def _local(distributed: Any, workers: int) -> Iterator[Any]:
    """Processes of this machine, one thread each; one that dies is started again."""
    with _environment(), tempfile.TemporaryDirectory(prefix="pointcoord-") as folder:
        with _deaf_to_interrupts():
            cluster = distributed.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                # No pages of its own; the port of those that any other cluster here may have is left alone.
                dashboard_address=None,
                scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
                memory_limit=0,
                local_directory=folder,
                silence_logs=logging.CRITICAL + 1,
            )
        try:
            yield cluster
        finally:
            with suppress(Exception):
                cluster.close(timeout=ANSWER)


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Threads and processes that begin in the block, and theirs, never see Ctrl-C.

    A terminal sends it to all; who ends the workers is this program. It waits until the block is over.
    """
    # Whoever starts the tracker of multiprocessing hears again.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _environment() -> Iterator[None]:
    """What the processes are started with, also those that are started later in the place of others.

    Dask hands them what it finds here, and adds to it.
    """
    before = dict(os.environ)
    os.environ.update(ENVIRONMENT)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def _require_scheduler(distributed: Any, address: str, words: str) -> None:
    """See that a scheduler answers: a client of something else waits for ever, or for long.

    Raises:
        NoCluster: none does.
    """
    comm = import_module("distributed.comm")

    async def asked() -> Any:
        how = distributed.Security().get_connection_args("client")
        line = await comm.connect(address, timeout=ANSWER, **how)
        try:
            await line.write({"op": "identity", "n_workers": 0, "reply": True})
            return await line.read()
        finally:
            line.abort()

    async def answered() -> Any:
        return await asyncio.wait_for(asked(), ANSWER)

    began = time.monotonic()
    try:
        answer = asyncio.run(answered())
        if not isinstance(answer, Mapping) or answer.get("type") != "Scheduler":
            raise ValueError("something else answers")
    except Exception as error:
        # A limit of time that runs out has no words of its own, and what another program says may be taken
        # for the size of an answer.
        told = one_line(str(error)) or (
            "no answer" if isinstance(error, TimeoutError) else type(error).__name__
        )
        if isinstance(error, MemoryError):
            told = "something else answers"
        waited = f"{told}, after {time.monotonic() - began:.1f} s"
        raise NoCluster(
            f"{words} does not answer as a Dask scheduler ({waited}); give --scheduler an address such as "
            "tcp://HOST:8786, where dask scheduler runs, or leave it out"
        ) from None


def _client(distributed: Any, cluster: Any) -> Any:
    with warnings.catch_warnings():
        # Of other versions; those that matter are refused.
        warnings.simplefilter("ignore")
        return distributed.Client(cluster, timeout=START, set_as_default=False)


def _close(client: Any) -> None:
    with suppress(Exception):
        client.close(timeout=ANSWER)
