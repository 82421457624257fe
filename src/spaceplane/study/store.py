"""The result store: one SQLite file that remembers every finished computation.

Safety rests on SQLite's write-ahead log: a result is inserted in one transaction, so a process killed at any moment
leaves either the whole result or nothing. Claims keep two processes from computing the same case; a claim ends with
its result, with its process, or when its lease runs out.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import socket
import sqlite3
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

from spaceplane.errors import InputError
from spaceplane.study.keys import canonical

APPLICATION_ID = 0x53504C4E  # "SPLN", in the file's header
SCHEMA_VERSION = 1
LEASE_SECONDS = 300.0
BUSY_SECONDS = 60.0

_SCHEMA = """
CREATE TABLE IF NOT EXISTS results (
  key TEXT PRIMARY KEY, label TEXT NOT NULL, inputs TEXT NOT NULL, result TEXT NOT NULL, checksum TEXT NOT NULL,
  seconds REAL NOT NULL, created TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS claims (
  key TEXT PRIMARY KEY, host TEXT NOT NULL, pid INTEGER NOT NULL, started TEXT NOT NULL, expires REAL NOT NULL
  ) WITHOUT ROWID;
"""

_OWN_CLAIM = "key = ? AND host = ? AND pid = ? AND started = ?"


class ResultStore:
    """Finished results by key, in one SQLite file, shared safely between processes.

    Args:
        path: the file; made, with its folder, where it does not exist.
        lease_s: seconds after which a claim that nobody renews may be taken over.

    Raises:
        InputError: the file is damaged, is no result store, or cannot be written. A damaged file is left as it is.
    """

    def __init__(self, path: Path | str, lease_s: float = LEASE_SECONDS) -> None:
        self.path = Path(path)
        self.lease_s = lease_s
        self._make_folder()
        if self.path.exists() and self.path.stat().st_size > 0:
            self._check()
        with self._guard():
            self._db = sqlite3.connect(self.path, timeout=BUSY_SECONDS, isolation_level=None)
            try:
                self._prepare()
            except BaseException:
                self._db.close()
                raise

    def __enter__(self) -> ResultStore:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Release the file; what was put in stays."""
        self._db.close()

    def finished(self, keys: Iterable[str]) -> set[str]:
        """Return those of `keys` that have a result."""
        with self._guard():
            return {key for key in keys if self._db.execute("SELECT 1 FROM results WHERE key = ?", (key,)).fetchone()}

    def get(self, key: str) -> dict | None:
        """Return the result of `key`, or None.

        Raises:
            InputError: the stored text does not match its checksum.
        """
        with self._guard():
            row = self._db.execute("SELECT result, checksum FROM results WHERE key = ?", (key,)).fetchone()
        if row is None:
            return None
        if _checksum(row[0]) != row[1]:
            raise self._damaged(f"result {key[:12]} fails its checksum")
        return json.loads(row[0])

    def seconds(self, keys: Iterable[str]) -> list[float]:
        """Return the computing times of those of `keys` that have a result, s."""
        with self._guard():
            rows = (self._db.execute("SELECT seconds FROM results WHERE key = ?", (key,)).fetchone() for key in keys)
            return [row[0] for row in rows if row]

    def put(self, key: str, label: str, inputs: dict, result: dict, seconds: float) -> bool:
        """Store a finished result and end its claim, in one transaction.

        Args:
            key: see `keys.result_key`.
            label: what a person calls it.
            inputs: what it was computed from (kept for inspection; JSON values).
            result: JSON values, all numbers finite.
            seconds: what it took to compute, s.

        Returns:
            False when another process had stored it before; the first result stays.

        Raises:
            InputError: a number is not finite; or the disk is full or fails (nothing stored before is lost).
        """
        try:
            text = json.dumps(result, sort_keys=True, separators=(",", ":"), allow_nan=False)
        except ValueError as error:
            raise InputError(f"result of {label}: {error}; missing numbers must be null") from error
        row = (key, label, canonical(inputs), text, _checksum(text), seconds, datetime.now(UTC).isoformat())
        with self._guard(), self._transaction():
            cursor = self._db.execute("INSERT OR IGNORE INTO results VALUES (?, ?, ?, ?, ?, ?, ?)", row)
            self._db.execute("DELETE FROM claims WHERE key = ?", (key,))
            return cursor.rowcount == 1

    def claim(self, key: str) -> bool:
        """Take the case `key` for this process; False when it is finished or a live process has it."""
        host, pid, started = _identity()
        with self._guard(), self._transaction():
            if self._db.execute("SELECT 1 FROM results WHERE key = ?", (key,)).fetchone():
                return False
            row = self._db.execute("SELECT host, pid, started, expires FROM claims WHERE key = ?", (key,)).fetchone()
            if row is not None and row[3] > time.time() and _alive(*row[:3]):
                return False
            values = (key, host, pid, started, time.time() + self.lease_s)
            self._db.execute("INSERT OR REPLACE INTO claims VALUES (?, ?, ?, ?, ?)", values)
            return True

    def release(self, key: str) -> None:
        """Give up this process's claim on `key`, if it has one."""
        with self._guard():
            self._db.execute(f"DELETE FROM claims WHERE {_OWN_CLAIM}", (key, *_identity()))

    @contextlib.contextmanager
    def holding(self, key: str) -> Iterator[None]:
        """Keep the claim on `key` alive while the body computes; it is released afterwards, whatever happens."""
        stop = threading.Event()
        keeper = threading.Thread(target=self._renew, args=(key, stop), daemon=True)
        keeper.start()
        try:
            yield
        finally:
            stop.set()
            keeper.join()
            self.release(key)

    def _renew(self, key: str, stop: threading.Event) -> None:
        while not stop.wait(self.lease_s / 4):
            # A renewal that fails (disk full, file locked) costs at most a case computed twice; the result's own
            # insertion reports the trouble.
            with contextlib.suppress(sqlite3.Error), self._second_connection() as db:
                db.execute(
                    f"UPDATE claims SET expires = ? WHERE {_OWN_CLAIM}", (time.time() + self.lease_s, key, *_identity())
                )

    @contextlib.contextmanager
    def _second_connection(self) -> Iterator[sqlite3.Connection]:
        """A connection of the calling thread's own, committed at the end."""
        with contextlib.closing(sqlite3.connect(self.path, timeout=5.0)) as db, db:
            yield db

    def _make_folder(self) -> None:
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"store {self.path}: cannot make its folder ({error.strerror})") from error
        if self.path.is_dir():
            raise InputError(f"store {self.path}: is a folder; name a file")

    def _check(self) -> None:
        """Look for damage through a read-only connection, which cannot alter the file."""
        try:
            with self.path.open("rb") as file:
                if file.read(16) != b"SQLite format 3\0":
                    raise self._damaged("it does not begin as a result store does")
        except OSError as error:
            raise InputError(f"store {self.path}: cannot be read ({error.strerror})") from error
        uri = f"{self.path.resolve().as_uri()}?mode=ro"
        with self._guard(), contextlib.closing(sqlite3.connect(uri, uri=True, timeout=BUSY_SECONDS)) as db:
            if db.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
                raise self._damaged("SQLite's own check fails")
            tables = {row[0] for row in db.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
            if tables and db.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
                raise InputError(f"store {self.path}: is an SQLite file of another program; name another file")
            version = db.execute("PRAGMA user_version").fetchone()[0]
            if tables and version != SCHEMA_VERSION:
                raise InputError(
                    f"store {self.path}: has schema version {version}, this program reads {SCHEMA_VERSION}; "
                    "name another file"
                )

    def _prepare(self) -> None:
        self._db.execute("PRAGMA journal_mode = WAL")
        self._db.execute("PRAGMA synchronous = FULL")
        with self._transaction():
            for statement in _SCHEMA.split(";"):
                self._db.execute(statement)
            self._db.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            self._db.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[None]:
        self._db.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            if self._db.in_transaction:
                self._db.execute("ROLLBACK")
            raise
        try:
            self._db.execute("COMMIT")
        except BaseException:
            if self._db.in_transaction:
                self._db.execute("ROLLBACK")
            raise

    @contextlib.contextmanager
    def _guard(self) -> Iterator[None]:
        """Turn SQLite's errors into one line that names the file and what to do."""
        try:
            yield
        except sqlite3.Error as error:
            code = getattr(error, "sqlite_errorcode", 0) & 0xFF
            if code in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB):
                raise self._damaged(str(error)) from error
            advice = {
                sqlite3.SQLITE_FULL: "the disk is full; nothing stored is lost; free some space and run again",
                sqlite3.SQLITE_IOERR: "cannot be written (disk full or failing); nothing stored is lost; run again",
                sqlite3.SQLITE_READONLY: "is not writable; change its permissions or name another file",
                sqlite3.SQLITE_PERM: "is not writable; change its permissions or name another file",
                sqlite3.SQLITE_CANTOPEN: "cannot be opened or made; check its folder or name another file",
                sqlite3.SQLITE_BUSY: f"was locked by another process for {BUSY_SECONDS:.0f} s; run again",
            }.get(code)
            if advice is None:
                raise
            raise InputError(f"store {self.path}: {advice}") from error

    def _damaged(self, why: str) -> InputError:
        return InputError(f"store {self.path}: damaged ({why}); move it away, or restore a copy, and run again")


def _checksum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _identity() -> tuple[str, int, str]:
    return _host(), os.getpid(), _start_time(os.getpid())


@cache
def _host() -> str:
    """Name where process numbers mean something: the machine and, on Linux, its boot and process namespace."""
    parts = [socket.gethostname()]
    with contextlib.suppress(OSError):
        parts.append(Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()[:8])
        parts.append(str(Path("/proc/self/ns/pid").stat().st_ino))
    return ":".join(parts)


def _start_time(pid: int) -> str:
    """Return the process's start in clock ticks (Linux), which tells a reused process number; empty elsewhere.

    A process that has ended but is not yet reaped by its parent counts as gone.
    """
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    except (OSError, IndexError):
        return ""
    return "" if fields[0] in "ZX" else fields[19]


def _alive(host: str, pid: int, started: str) -> bool:
    """Whether the process that claimed may still be running; True when that cannot be known from here."""
    if host != _host() or sys.platform == "win32":
        return True
    if started:
        return _start_time(pid) == started
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
