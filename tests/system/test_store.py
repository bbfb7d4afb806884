# SPDX-License-Identifier: Apache-2.0
"""The broker's store: mail that survives kill -9 of the broker, and files that it refuses."""
import contextlib
import os
import pathlib
import random
import resource
import sqlite3
import subprocess

from support import (MUSTER, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for, whole_lines)

# A lone sender may have 16,384 mails in a box, however slow its receiver is.
MAILS, KILLS, WINDOW = 16000, 6, 200


def receipts(path):
    """The numbers of mails that were answered for, and what else was said."""
    good, bad = set(), []
    for line in whole_lines(path):
        first, last, outcome = line.split()
        if outcome in ("stored", "delivered"):
            good.update(range(int(first), int(last) + 1))
        else:
            bad.append(line)
    return good, bad


def taken(path):
    """The numbers that the receiver has had, in order."""
    return [int(line.split()[3]) for line in whole_lines(path)]


def receiver_start(processes, domain, out):
    return processes.start(program("mail_receiver"), domain, "receiver", out / "record")


def storer_start(processes, domain, out, count, level="logged", name="sender"):
    return processes.start(program("mail_storer"), domain, name, "receiver", count, level,
                           out / f"receipts-{name}")


def broker_again(processes, domain, store):
    """Starts a broker, without waiting for anything: whoever is there must find it."""
    return processes.start(MUSTER, "broker", "main", "--domain", domain, "--store", store)


def has_open(process, path):
    """Whether a process lives and has a file open."""
    files = pathlib.Path(f"/proc/{process.pid}/fd")
    with contextlib.suppress(FileNotFoundError):  # one that was closed meanwhile
        return any(file.readlink() == path for file in files.iterdir())
    return False


def kill(process):
    process.kill()
    process.wait()


def lives(out, domain, level, kills, mails, seed):
    """Kills the broker again and again, by the progress of sender and receiver in turn."""
    dice = random.Random(seed)
    store = out / "store.db"
    with Processes() as processes:
        broker = broker_start(processes, domain, "--store", store)
        receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 10, "the receiver in the white pages")
        sender = storer_start(processes, domain, out, mails, level)
        for turn in range(kills):
            at = mails * (turn + dice.random()) / (kills + 1)
            watch = dice.choice((lambda: len(receipts(out / "receipts-sender")[0]),
                                 lambda: len(whole_lines(out / "record"))))
            wait_for(lambda: watch() >= at, 60, f"mail {at:.0f} of life {turn} (seed {seed})")
            kill(broker)
            broker = broker_again(processes, domain, store)
        check_equal(sender.wait(60), 0, f"the sender's end (seed {seed})")
        wait_for(lambda: len(set(taken(out / "record"))) >= mails, 30,
                 f"all mails at the receiver (seed {seed})")
        broker.terminate()
        broker.wait()
    good, bad = receipts(out / "receipts-sender")
    check_equal(bad, [], f"other receipts (seed {seed})")
    check_equal(len(good), mails, f"mails answered for (seed {seed})")
    check_equal(taken(out / "record"), list(range(1, mails + 1)), f"the record (seed {seed})")
    with contextlib.closing(sqlite3.connect(store)) as db:
        check_equal(db.execute("SELECT count(*) FROM mails").fetchone()[0], 0, "rows left")
        check_equal(db.execute("PRAGMA integrity_check").fetchone()[0], "ok", "the file")


def test_a_broker_killed_in_mid_write_and_mid_drain_loses_nothing_and_doubles_nothing():
    with folder() as out:
        lives(out, new_domain(), "logged", KILLS, MAILS, random.randrange(1 << 30))


def test_synced_mail_likewise():
    with folder() as out:
        lives(out, new_domain(), "synced", 2, MAILS // 4, random.randrange(1 << 30))


def test_names_and_mail_for_the_absent_are_back_and_ram_mail_is_not():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = out / "deep" / "er" / "store.db"
        broker = broker_start(processes, domain, "--store", store)
        receiver = receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        receiver.terminate()
        receiver.wait()
        check_equal(storer_start(processes, domain, out, 100, "ram", "idle").wait(30), 0, "ram")
        check_equal(storer_start(processes, domain, out, 3000, "logged").wait(30), 0, "logged")
        kill(broker)
        broker = broker_start(processes, domain, "--store", store)
        line = members(domain)["receiver"]
        check_equal((line["state"], line["kind"]), ("absent", "agent"), "the receiver's line")
        receiver_start(processes, domain, out)
        wait_for(lambda: len(taken(out / "record")) >= 3000, 10, "the stored mail")
        # A mail after the others shows that nothing else was to come.
        check_equal(muster("send", "receiver", "count", "0", "--domain", domain).returncode, 0,
                    "mail after all")
        wait_for(lambda: len(taken(out / "record")) > 3000, 10, "the mail after all")
        check_equal([line.split()[1:] for line in whole_lines(out / "record")],
                    [["sender", "count", str(i)] for i in range(1, 3001)] +
                    [["operator", "count", "0"]], "the record")


def test_receipts_go_to_a_sender_of_an_earlier_life_of_the_broker():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = out / "store.db"
        broker = broker_start(processes, domain, "--store", store)
        receiver = receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        receiver.terminate()
        receiver.wait()
        sender = processes.start(program("mail_sender"), domain, "sender", "receiver", 50, 60,
                                 "logged", stdout=subprocess.PIPE)
        wait_for(lambda: store_rows(out / "store.db") == 50, 10, "the mails on disk")
        kill(broker)
        broker_again(processes, domain, store)
        receiver_start(processes, domain, out)
        output, _ = sender.communicate(timeout=60)
        check_equal(output.decode().strip(), "delivered 50", "the sender's receipts")


def store_rows(path):
    """Mails in a store that a broker has open: of a copy of its files."""
    with folder() as copy:
        for suffix in ("", "-wal"):
            source = path.with_name(path.name + suffix)
            if source.exists():
                (copy / source.name).write_bytes(source.read_bytes())
        with contextlib.closing(sqlite3.connect(copy / path.name)) as db:
            try:
                return db.execute("SELECT count(*) FROM mails").fetchone()[0]
            except sqlite3.DatabaseError:
                return None


def test_a_full_disk_refuses_durable_mail_and_the_rest_goes_on():
    domain = new_domain()
    limit, endless = 256 * 1024, resource.getrlimit(resource.RLIMIT_FSIZE)[1]
    with folder() as out, Processes() as processes, (out / "log").open("w") as log:
        store = out / "store.db"
        broker = processes.start(
            MUSTER, "broker", "main", "--domain", domain, "--store", store,
            stderr=log,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, endless)))
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
        receiver = receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        receiver.terminate()
        receiver.wait()
        storer_start(processes, domain, out, 5000, "logged").wait(30)
        good, bad = receipts(out / "receipts-sender")
        refused = sum(int(l.split()[1]) - int(l.split()[0]) + 1 for l in bad if "no-store" in l)
        check(good and refused, f"{len(good)} stored, {refused} refused")
        check_equal(len(good) + refused, 5000, "answers")
        done = muster("send", "receiver", "count", "0", "--domain", domain)
        check_equal((done.returncode, done.stdout.strip()), (0, "stored"), "ram mail")
        receiver_start(processes, domain, out)
        # More goes out when it is on disk that these are through.
        wait_for(lambda: len(taken(out / "record")) >= WINDOW, 10, "a window of mails")
        resource.prlimit(broker.pid, resource.RLIMIT_FSIZE, (endless, endless))
        wait_for(lambda: taken(out / "record")[-1:] == [0], 10, "ram mail, and all before it")
        check_equal(taken(out / "record"), sorted(good) + [0], "the record")
        check(broker.poll() is None, "the broker lives")
        text = (out / "log").read_text()
        check(text.count("store-cannot-write") >= 1, f"the log: {text}")


def test_a_broker_whose_disk_is_full_starts_and_hands_out_what_it_has():
    domain = new_domain()
    with folder() as out, Processes() as processes, (out / "log").open("w") as log:
        store = out / "store.db"

        def start(**more):
            broker = processes.start(MUSTER, "broker", "main", "--domain", domain, "--store", store,
                                     stderr=log, **more)
            wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
            return broker

        broker = start()
        receiver = receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        receiver.terminate()
        receiver.wait()
        storer_start(processes, domain, out, 100, "logged").wait(30)
        broker.kill()
        broker.wait()
        endless = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
        broker = start(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, endless)))
        for _ in range(2):
            done = muster("send", "receiver", "count", "0", "--level", "logged", "--domain", domain)
            check_equal((done.returncode, "no-store" in done.stderr), (9, True), done.stderr)
        check("store-cannot-write" in (out / "log").read_text(), "the log says so")
        receiver_start(processes, domain, out)
        wait_for(lambda: len(taken(out / "record")) >= 100, 10, "all that was stored")
        resource.prlimit(broker.pid, resource.RLIMIT_FSIZE, (endless, endless))
        wait_for(lambda: muster("send", "receiver", "count", "0", "--level", "logged", "--domain",
                                domain).returncode == 0, 10, "it stores again")
        broker.terminate()
        check_equal(broker.wait(30), 0, "its end")
        check_equal(store_rows(store), 0, "mails that wait")


def test_a_store_that_is_removed_or_replaced_is_noticed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = out / "store.db"
        broker = processes.start(MUSTER, "broker", "main", "--domain", domain, "--store", store)
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")

        def send():
            return muster("send", "bob", "x", "--level", "logged", "--domain", domain).returncode

        muster("send", "broker", "hello", "--as", "bob", "--domain", domain)
        check_equal(send(), 0, "mail that waits")
        for path in (store, store.with_name("store.db-wal")):
            aside = out / "aside"
            path.rename(aside)
            check_equal(send(), 9, f"{path.name} is gone")
            path.write_bytes(b"another file")
            wait_for(lambda: send() == 9, 10, f"{path.name} is another")
            aside.rename(path)
            wait_for(lambda: send() == 0, 10, f"{path.name} is back")
        store.rename(out / "aside")
        store.write_bytes(b"another file")
        broker.terminate()
        check_equal(broker.wait(30), 0, "its end")
        check_equal(store.read_bytes(), b"another file", "what is not its own is left as it is")


def refused_start(domain, store):
    done = muster("broker", "main", "--domain", domain, "--store", store, timeout=60)
    return done.returncode, done.stderr


def test_files_that_are_no_store_are_refused_and_left_as_they_are():
    domain = new_domain()
    with folder() as out:
        garbage = out / "garbage.db"
        garbage.write_bytes(os.urandom(100000))
        short = out / "short.db"
        short.write_text("my only copy of a poem\n")
        foreign = out / "foreign.db"
        with contextlib.closing(sqlite3.connect(foreign)) as db:
            db.execute("CREATE TABLE t (x)")
            db.commit()
        logged, log = out / "logged.db", out / "logged.db-wal"
        with contextlib.closing(sqlite3.connect(out / "busy.db")) as db:
            db.execute("PRAGMA journal_mode = WAL")
            db.execute("CREATE TABLE t (x)")
            db.commit()
            logged.write_bytes((out / "busy.db").read_bytes())
            log.write_bytes((out / "busy.db-wal").read_bytes())
        for path in (garbage, short, foreign, logged):
            before = path.read_bytes()
            log_before = log.read_bytes()
            code, text = refused_start(domain, path)
            check_equal(code, 3, f"{path.name}: {text}")
            check(str(path) in text and "--store" in text, text)
            check_equal(path.read_bytes(), before, f"{path.name} afterwards")
            check(log.exists() and log.read_bytes() == log_before, f"the log of {path.name}")
        for path in (out, garbage / "below.db", "/proc/muster/x.db"):
            code, text = refused_start(domain, path)
            check_equal(code, 9, f"{path}: {text}")
            check(str(path) in text and "--store" in text, text)


def test_the_next_broker_waits_for_the_store_of_one_that_is_dying():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = out / "store.db"
        first = broker_start(processes, domain, "--store", store)
        second = broker_again(processes, domain, store)
        wait_for(lambda: has_open(second, store), 10, "it has opened the store")
        kill(first)
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
        second.terminate()
        check_equal(second.wait(30), 0, "its end")


def test_stores_of_another_version_and_damaged_ones_are_refused():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = out / "store.db"
        broker = broker_start(processes, domain, "--store", store)
        code, text = refused_start(domain, store)
        check_equal(code, 9, f"a second broker: {text}")
        check("in use" in text, text)
        for i in range(20):
            check_equal(muster("ps", "--as", f"n{i}", "--domain", domain).returncode, 0, "ps")
        broker.terminate()
        check_equal(broker.wait(), 0, "the broker's end")
        whole = store.read_bytes()
        with contextlib.closing(sqlite3.connect(store)) as db:
            db.execute("UPDATE meta SET value = 1 WHERE key = 'schema'")
            db.commit()
        code, text = refused_start(domain, store)
        check_equal(code, 3, f"another version: {text}")
        check("of version 1" in text, text)
        store.write_bytes(whole)
        for key, value in (("incarnation", -1), ("number_base", -1), ("number_base", 2**63 - 1)):
            store.write_bytes(whole)
            with contextlib.closing(sqlite3.connect(store)) as db:
                db.execute("UPDATE meta SET value = ? WHERE key = ?", (value, key))
                db.commit()
            code, text = refused_start(domain, store)
            check_equal(code, 3, f"{key} {value}: {text}")
            check("damaged" in text, text)
        store.write_bytes(whole[:len(whole) // 2])
        code, text = refused_start(domain, store)
        check_equal(code, 3, f"half a file: {text}")
        check("damaged" in text, text)
        store.write_bytes(whole)
        broker_start(processes, domain, "--store", store)


VERSION_2 = """
PRAGMA application_id = 1836413812;
CREATE TABLE meta (key TEXT PRIMARY KEY, value) WITHOUT ROWID;
CREATE TABLE agents (name TEXT PRIMARY KEY, kind TEXT, durable_seq INTEGER, reserved_seq INTEGER,
  failed_seq INTEGER) WITHOUT ROWID;
CREATE TABLE mails (id INTEGER PRIMARY KEY, sender TEXT, seq INTEGER, waiting TEXT, level INTEGER,
  expires_wall_ns INTEGER, dst TEXT, layer INTEGER, performative TEXT, language TEXT,
  ontology TEXT, reply_with TEXT, in_reply_to TEXT, conversation TEXT, reply_by_ns INTEGER,
  priority INTEGER, hops INTEGER, due_1_ns INTEGER, ttl_ns INTEGER, content TEXT);
CREATE TABLE lines (kind TEXT, slot INTEGER, key TEXT, agent TEXT, present INTEGER,
  attributes TEXT, lease_ns INTEGER, stamp_ns INTEGER, origin TEXT,
  PRIMARY KEY (kind, slot)) WITHOUT ROWID;
INSERT INTO meta VALUES ('schema', 2), ('store', 'x'), ('incarnation', 7), ('run_wall_ns', 0);
INSERT INTO agents VALUES ('sender', 'agent', 9, 1048576, 0), ('receiver', 'agent', 0, 0, 0),
  ('other', 'agent', 0, 0, 0);
"""


def test_a_store_of_the_version_before_is_taken_over():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = out / "store.db"
        with contextlib.closing(sqlite3.connect(store)) as db:
            db.executescript(VERSION_2)
            for row, number, waits in ((3, 1, "receiver"), (4, 2, "other,receiver"), (9, 3, "other")):
                db.execute("INSERT INTO mails (id, sender, seq, waiting, level, dst, layer, content)"
                           " VALUES (?, 'sender', ?, ?, 1, 'receiver,other', 3, ?)",
                           (row, number, waits, f"count {number}"))
            db.commit()
        broker = broker_start(processes, domain, "--store", store)
        receiver_start(processes, domain, out)
        wait_for(lambda: taken(out / "record") == [1, 2], 10, "the receiver's mails")
        storer_start(processes, domain, out, 5, name="later").wait(30)
        wait_for(lambda: taken(out / "record") == [1, 2, 1, 2, 3, 4, 5], 10, "new mails, too")
        wait_for(lambda: store_rows(store) == 2, 10, "the acknowledgements on disk")
        broker.terminate()
        check_equal(broker.wait(), 0, "the broker's end")
        with contextlib.closing(sqlite3.connect(store)) as db:
            check_equal(db.execute("SELECT value FROM meta WHERE key = 'schema'").fetchone(), (3,),
                        "the version")
            check_equal(db.execute("SELECT id, sender, seq, waiting, content FROM mails").fetchall(),
                        [(4, "sender", 2, "other", "count 2"), (9, "sender", 3, "other", "count 3")],
                        "what waits still")


def test_without_a_store_durable_mail_is_refused():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        check_equal(storer_start(processes, domain, out, 10).wait(30), 0, "the sender's end")
        good, bad = receipts(out / "receipts-sender")
        check(not good and all("no-store" in line for line in bad), f"{good} {bad}")
