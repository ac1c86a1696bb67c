"""A file is whole or not there, whatever stops its writing."""

import errno
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path
from typing import BinaryIO

import pytest

from validate.errors import NotFinished
from validate.output.files import require_writable, write_whole


def new(stream: BinaryIO) -> None:
    stream.write(b"new")


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.parametrize("before", [None, b"old"])
@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_what_was_there_is_whole_and_nothing_else_is_left(
    before: bytes | None, error: BaseException, tmp_path: Path
) -> None:
    target = tmp_path / "x.json"
    if before is not None:
        target.write_bytes(before)

    def stops(stream: BinaryIO) -> None:
        stream.write(b"half")
        stream.flush()
        raise error

    with pytest.raises((NotFinished, KeyboardInterrupt)):
        write_whole(str(target), stops)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == ([] if before is None else [before])


def test_two_runs_with_one_file_both_write_it_whole(tmp_path: Path) -> None:
    target = tmp_path / "x.json"

    def slower(stream: BinaryIO) -> None:
        stream.write(b"slower")
        require_writable(str(target))
        write_whole(str(target), new)
        assert target.read_bytes() == b"new"

    write_whole(str(target), slower)
    assert target.read_bytes() == b"slower"
    assert [*tmp_path.iterdir()] == [target]


def test_a_killed_run_leaves_no_half_file_and_to_ask_whether_a_file_can_be_written_changes_nothing(
    tmp_path: Path,
) -> None:
    target = tmp_path / "[x].json"
    killed = (
        "import os, signal, sys\n"
        "from validate.output.files import write_whole\n"
        "write_whole(sys.argv[1], lambda stream: os.kill(os.getpid(), signal.SIGKILL))"
    )
    subprocess.run([sys.executable, "-c", killed, target], check=False, cwd=Path(__file__).parents[3])
    (left,) = tmp_path.iterdir()
    assert left.suffix == ".part"
    left.unlink()
    write_whole(str(target), new)
    before = target.stat().st_mtime_ns
    for one in (target, tmp_path / "y.json"):
        require_writable(str(one))
    assert target.stat().st_mtime_ns == before
    assert [*tmp_path.iterdir()] == [target]


def test_the_content_is_on_the_disk_before_it_has_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = []
    fsync, replace = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda handle: (done.append("fsync"), fsync(handle)))
    monkeypatch.setattr(os, "replace", lambda a, b: (done.append("replace"), replace(a, b)))
    write_whole(str(tmp_path / "x.json"), new)
    assert done == ["fsync", "replace", "fsync"]  # the last one is the folder's


def test_rights_and_links_stay_and_a_new_file_has_the_usual_rights(tmp_path: Path) -> None:
    real, link, made = tmp_path / "real", tmp_path / "link", tmp_path / "new"
    real.write_bytes(b"old")
    real.chmod(0o640)
    link.symlink_to(real)
    write_whole(str(link), new)
    assert (link.is_symlink(), real.read_bytes(), mode(real)) == (True, b"new", 0o640)
    before = os.umask(0o027)
    try:
        write_whole(str(made), new)
    finally:
        os.umask(before)
    assert mode(made) == 0o640


def test_a_pipe_is_written_as_it_is(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    reader.start()
    require_writable(str(pipe))
    write_whole(str(pipe), new)
    reader.join(10)
    assert read == [b"new"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
