/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file node.h
 * The process around the broker: DDS, files, the store.
 */
#ifndef MUSTER_BROKER_NODE_H
#define MUSTER_BROKER_NODE_H

#include "broker/control/broker.h"
#include "broker/services/services.h"
#include "bus/wire/beacons.h"
#include "core/network.h"

/* --- outlets.c ------------------------------------------------------------------------------- */

/* The writers of Deliveries: one into the partition of each process that the broker serves. */

struct outlet {
    char process[MU_PROCESS_MAX + 1]; /* "": it is closed */
    struct bus_writer writer;
    uint64_t incarnation; /* of the process */
    uint32_t hearers;     /* how many hear multicasts, when it was last asked whether it does */
    uint32_t readers;     /* it has ever had */
    uint32_t readers_now;
    uint64_t heard_ns; /* when its last Up came, by the machine's clock; 0: none has */
};

struct outlets {
    struct bus *bus;
    struct broker *broker;
    struct bus_writer multicasts;
    bool once; /* they are used */
    const struct bus_reader *ups;
    struct outlet at[MU_PROCESSES_MAX]; /* as the broker's processes */
};

/**
 * @param ups   the broker's reader of Ups; stays the caller's
 * @param once  what is for many goes out in multicasts.  They have a line for each receiver, which
 *              on loopback costs nothing, and on a network several packets where one was enough
 */
MU_MUST_USE mu_result outlets_open(struct outlets *m, struct bus *bus, struct broker *b,
                                   const struct bus_reader *ups, bool once);

/** @return the writer to a process, or to all (BUS_TO_ALL); NULL: there is none */
const struct bus_writer *outlets_writer(struct outlets *m, const char *process);

/** @return the bag of a process, or NULL: it has none */
struct outlet *outlets_find(struct outlets *m, const char *process);

/** @return when that process spoke that has been silent for the longest, 0: one never has, or there
 *          is none */
uint64_t outlets_spoke_ns(struct outlets *m);

/** Closes the bags of processes that are gone for good, and opens one for every new process, and
 * every new life of a neighbour, which keeps its name. */
void outlets_follow(struct outlets *m, uint64_t now_ns);

/**
 * Tells the broker which processes have matched, or have not any more.
 *
 * @param mute  a process that gets mail and sends none
 * @param all   false: only those that had not matched are looked at
 * @return whether any has not
 */
bool outlets_look(struct outlets *m, const char *mute, bool all, uint64_t now_ns);

/* --- beacon_table.c -------------------------------------------------------------------------- */

/* The brokers of the network as this one sees them, and whether its own name is its own.  Pure. */

struct beacon_table {
    muster_Beacon own; /* what this one says of itself */
    struct beacons others;
    bool overflows; /* there have been more others than it can hold */
};

enum beacon_news {
    BEACON_NOTHING, /* it is known, or our own, or there was no room before */
    BEACON_MET,     /* a broker that was not there before, or another life of one */
    BEACON_FULL,    /* the first of those that there is no room for */
    BEACON_LATER,   /* another broker has our name, and must give way */
    BEACON_EARLIER, /* another broker has our name, and we must give way */
};

/** Takes a heartbeat. */
enum beacon_news beacon_table_hear(struct beacon_table *b, const muster_Beacon *beacon);

/* --- heartbeat.c ----------------------------------------------------------------------------- */

/*
 * When a broker says that it is there: every 300 ms, and every second while all of its processes
 * speak to it.
 *
 * A Beacon wakes every process at once, and every one acknowledges it: mail that is under way then
 * waits for all of them.  A process that has sent an Up since the last look has heard of the
 * broker, and DDS takes every packet of the broker's for a sign of its life.
 */

struct heartbeat {
    uint64_t told_ns;   /* when a Beacon went out last; 0: the next one is due */
    uint64_t looked_ns; /* when it was asked last whether one is due */
};

/** @return whether it is time to ask heartbeat_beats() */
bool heartbeat_looks(const struct heartbeat *p, uint64_t now_ns);

/**
 * Looks whether a Beacon is to go out, and notes that it does.
 *
 * @param spoke_ns  all processes have spoken at that time or later; 0: one never has, or there is
 *                  none
 */
bool heartbeat_beats(struct heartbeat *p, uint64_t spoke_ns, uint64_t now_ns);

/* --- beacon.c -------------------------------------------------------------------------------- */

/* The Beacon on the network: says that this broker is there, and hears of the others. */

struct beacon {
    struct beacon_table beacons;
    struct bus_reader heard;
    struct bus_writer beacon;
    struct heartbeat pulse;
    bool sure;   /* no other broker has our name */
    bool yields; /* another one has it: this one is to end */
};

MU_MUST_USE mu_result beacon_open(struct beacon *h, struct bus *bus, struct broker *b);

/** Hears the other brokers; sets yields, and says so, when one of them has our name. */
void beacon_hear(struct beacon *h);

/**
 * Says that the broker is there, when that is due by the machine's clock.
 *
 * @param bags the readers that are to hear of it
 */
void beacon_tell(struct beacon *h, struct broker *b, struct outlets *outlets, uint64_t now_ns);

/** Takes the Beacon back; a broker that yields is to leave it to the other one. */
void beacon_close(struct beacon *h);

/* --- links.c --------------------------------------------------------------------------------- */

/* The other brokers on the network: what this one says to them, and hears from them. */

/* Acknowledgements go into the partition of the broker that they are for. */
struct links_line {
    char name[MU_NAME_MAX + 1]; /* "": it is closed */
    struct bus_writer ups;
};

struct links {
    struct bus *bus;
    struct bus_reader deliveries;
    struct bus_writer registration;
    struct links_line lines[MU_BROKERS_MAX]; /* by the places of the brokers among the Beacons */
    bool overflows; /* it was told that the broker has passed over another one */
};

/** @param place  "broker.NAME" of this broker */
MU_MUST_USE mu_result links_open(struct links *p, struct bus *bus, const char *place);

/** Opens a line to each broker that is there, and closes the others. */
void links_follow(struct links *p, const struct beacons *beacons, struct broker *b,
                  uint64_t now_ns);

/** Takes what other brokers deliver. */
void links_take(struct links *p, struct broker *b, uint64_t now_ns);

/** Announces and acknowledges, after the commit.  @return whether the network took all */
bool links_tell(struct links *p, struct broker *b);

/* --- telemetry.c ----------------------------------------------------------------------------- */

/*
 * Tells any DDS tool how the broker is: the topics BrokerStatus and PartStatus.
 *
 * What has changed is written at once, but at most every HEALTH_NEWS_NS; what changes with time
 * alone (ages, processor time, memory) every HEALTH_DRIFT_NS.
 */

#define HEALTH_NEWS_NS  100000000ull
#define HEALTH_DRIFT_NS 1000000000ull

struct telemetry {
    struct bus *bus;
    struct bus_writer status, parts;
    muster_BrokerStatus told; /* without what drifts */
    uint64_t told_ns;         /* when all was told, whether it was news or not; 0: it never was */
    uint64_t values[METRICS_MAX]; /* that were told last, in the order of the table */
};

MU_MUST_USE mu_result telemetry_open(struct telemetry *h, struct bus *bus);

/** Tells what there is to tell; to be called every HEALTH_NEWS_NS of the machine's clock. */
void telemetry_tell(struct telemetry *h, struct broker *b, uint64_t now_ns);

/** Tells everything for the last time, and waits until readers have it. */
void telemetry_close(struct telemetry *h, struct broker *b);

/* --- settings.c ------------------------------------------------------------------------------ */

/* What the command line of muster-broker says. */

enum { NAME_EXPIRY_MAX_S = 366 * 24 * 3600 };

struct settings {
    const char *name; /* of the broker; NULL: there is nothing to do */
    struct mu_network network;
    bool verbose, counters;
    double delivery_interval_ms;
    const char *policy, *audit; /* files; NULL: none */
    const char *store;          /* a file; "none"; NULL: the usual one */
    int64_t names;
    int64_t name_expiry_s;
    int64_t box_mails, box_bytes; /* 0: the most */
    const char *box_policy_word;
    muster_BoxPolicy box_policy;
};

/** @param s  out: zeroed memory.  @return MU_EXIT_DONE: go on; else the exit code */
int settings_read(struct settings *s, int argc, char **argv);

/* --- files.c --------------------------------------------------------------------------------- */

/* The broker's files: the trust policy is read at the start, the audit log is appended to. */

/** The largest policy file, in bytes. */
enum { FILES_POLICY_BYTES = 256 * 1024 };

struct files_audit {
    int fd;      /* -1: there is no audit log */
    bool failed; /* the last record could not be written */
    bool cut;    /* and a part of it stands there */
};

/**
 * Sets the broker's policy from a file.
 *
 * @return MU_OK; MU_FAULT_FILE, explained on standard error as file:line:column: what is expected
 */
MU_MUST_USE mu_result files_policy_load(struct broker *b, const char *path);

/** Opens the audit log; path NULL: none.  @return whether it can be written, explained if not */
bool files_audit_open(struct files_audit *f, const char *path);

/**
 * Writes down all that waits.  What cannot be written is counted and gone; the first time is
 * logged, and the first success after it.
 */
void files_audit_write(struct files_audit *f, struct broker *b);

/* --- disk.c ---------------------------------------------------------------------------------- */

/*
 * The broker's store: one SQLite file, which a person can read with the sqlite3 shell while no
 * broker has it open.
 *
 * What is written is the journal's business (journal.h); here it becomes rows.  A commit survives
 * the death of the process, and the loss of power when it was begun as LEVEL_SYNCED.  No data of a
 * user is ever deleted: a file that is not ours, or damaged, is refused and left as it is.
 */

struct disk;

/** Writes everything that the journal has, and tells it how that went.  @return whether it went */
bool disk_commit(struct disk *d, struct broker *b, muster_Level level, uint64_t now_ns);

/** Tidies up when nothing was written for a while; call now and then. */
void disk_rest(struct disk *d, uint64_t now_ns);

void disk_close(struct disk *d);

/* --- disk_open.c ----------------------------------------------------------------------------- */

/**
 * Opens a store, or makes it with the folders above it.  At start-up.
 *
 * @param wall_ns  nanoseconds since 1970
 * @return MU_OK; MU_FAULT_FILE: not a store, of another version, or damaged; MU_FAULT_OS: it cannot
 *         be made, read or written, or another broker has it; both explained on standard error
 */
MU_MUST_USE mu_result disk_open(struct disk **out, const char *path, uint64_t wall_ns);

/** Makes the default path, in $XDG_STATE_HOME/muster or ~/.local/state/muster.
 *  @return false: there is no home, or the path is too long */
bool disk_default_path(char *path, size_t size, int domain, const char *broker);

/** Gives all that is stored to durable_restore.  @return how much of it was not taken, or a fault
 *          that is explained on standard error: the file is damaged */
MU_MUST_USE mu_result disk_load(struct disk *d, struct broker *b, uint64_t *refused);

/* --- startup.c ------------------------------------------------------------------------------- */

/* Opens the broker, its store and its files as the command line says. */

struct startup {
    struct broker *broker;
    struct disk *disk; /* NULL: without a store */
    struct files_audit audit;
};

/** @return MU_EXIT_DONE, or the exit code, explained */
int startup_run(struct startup *o, const struct settings *s);

#endif
