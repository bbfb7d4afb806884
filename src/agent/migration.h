/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file migration.h
 * Migration: the way of an agent, or of its copy, out of its process.  docs/mobility.md has the
 * order of events, states/states.h the states.
 *
 * A robot takes part in one migration at a time, and a process in MU_CAPSULES_MAX.  A migration
 * carries the snapshot's header, one line, and the snapshot, in pieces that fit a mail.
 */
#ifndef MUSTER_AGENT_MIGRATION_H
#define MUSTER_AGENT_MIGRATION_H

#include "agent/states/states.h"
#include "core/text.h"
#include "mind/mind.h"
#include "muster/muster.h"
#include "wire.h"

enum {
    MIGRATION_SNAPSHOT_MAX = MU_CAPSULE_MAX, /* bytes of header and snapshot */
    SNAPSHOT_HEADER_FIELDS = 12,             /* of a header, without the asker */
    MIGRATION_ANSWER_MAX = 4 << 20,          /* bytes of several in one answer to a step */
};

/* The header of a snapshot: what a host needs beside the mind. */
struct snapshot_header {
    enum migration_purpose purpose;
    char name[MU_NAME_MAX + 1]; /* the name that it is to have */
    enum mu_state state;        /* the state that it goes on in */
    struct mu_passage passage;
    uint64_t mails;      /* that its rules have seen */
    uint32_t rules_left; /* that it may fire yet; 0: as many as it wants */
    /* The agent that the host tells of the arrival; "": none. */
    char asker[MU_NAME_MAX + 1], reply_with[MU_FIELD_MAX + 1];
    uint64_t seed; /* of a launched agent, which has rules in the place of a snapshot */
};

struct group_process;
struct robot;

struct migration {
    enum migration_state state;
    enum migration_purpose purpose;
    struct robot *robot; /* NULL: the migration is free */
    char host[MU_NAME_MAX + 1], name[MU_NAME_MAX + 1];
    char id[MU_FIELD_MAX + 1];                                 /* the label of the host's answer */
    char asker[MU_NAME_MAX + 1], reply_with[MU_FIELD_MAX + 1]; /* "": no agent asked */
    enum mu_state was;
    struct mu_passage passage;
    uint64_t until_ns;
    struct mu_text text; /* header and snapshot */
    size_t sent;
    uint32_t piece;
};

/** Takes the memory for the migrations of a group process. */
void migration_reserve(struct group_process *g);

/**
 * Begins a migration.
 *
 * @param asked  the directive that wants it, which is answered at the end; NULL: rules want it
 * @return MU_OK, or MU_REFUSED: the directive or the rules have an answer
 */
mu_result migration_begin(struct robot *r, const struct mind_travel *w,
                          const struct mu_mail *asked);

/**
 * Writes an agent: the snapshot's header, and the snapshot of its mind.
 *
 * @return NULL, or why that failed, which is fault's text
 */
const char *agent_write(struct robot *r, const struct snapshot_header *p, struct mu_text *out,
                        struct mu_fault *fault);

/** Lets all migrations go on as far as they can. */
void migration_round(struct group_process *g);

/** Takes a word of the broker about an agent on its way. */
void migration_hear(struct group_process *g, const muster_Trip *word);

/** Lets agents set out at the end of a step, before its answer. */
void migration_step_end(struct group_process *g);

/** Out of lock step, lets agents that set out stand still once the answer is out. */
void migration_step_answered(struct group_process *g);

/** Takes the answer of a host.  @return whether the mail is one */
bool migration_take_answer(struct group_process *g, const struct mu_mail *mail);

/** Adds the header, one line. */
void snapshot_header_add(struct mu_text *out, const struct snapshot_header *p);

/** Reads a header and moves behind it.  @return false: it is malformed */
bool snapshot_header_read(const char **text, struct snapshot_header *out);

#endif
