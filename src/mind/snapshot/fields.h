/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fields.h
 * A mind as text, and back: what the files of the snapshot share.
 *
 * The body of a snapshot is lines: a word that says what the line is about, then numbers and
 * fields. A field bears its type: i7, f0x1.8p+1, y"symbol", s"string", n"instance", a12 (the fact
 * of that index, a-1: one that is no more).
 */
#ifndef MUSTER_MIND_SNAPSHOT_FIELDS_H
#define MUSTER_MIND_SNAPSHOT_FIELDS_H

#include "mind/snapshot/snapshot.h"

enum { SNAPSHOT_NONE = -1, SNAPSHOT_KEY_MAX = 1024 };

/* The reader of a snapshot. */
struct snapshot {
    struct mind *mind;
    const char *at;
    struct mu_fault *fault;
    int line;
    const char *word; /* the symbol that was read last */
};

/* fields.c */

/** @return MU_FAULT_FILE: the fault has the line and the expected text */
mu_result snapshot_wrong(struct snapshot *c, const char *what);

/** Adds a space and a field.  @return false: it is of a type that cannot be written down */
bool snapshot_add(struct mu_text *out, unsigned short type, const void *value);

/** Adds a space and a symbol. */
void snapshot_add_word(struct mu_text *out, const char *word);

/** Adds a space and a number, to the last bit. */
void snapshot_add_real(struct mu_text *out, double x);

/** @return whether the line goes on with another field, before its end or a parenthesis */
bool snapshot_more(const struct snapshot *c);

/** Reads one field; its value is not installed.  @return false: there is none, or it is wrong */
bool snapshot_field(struct snapshot *c, struct field *out);

/** Reads the fields up to the line's end or a parenthesis.  @return NULL: one is wrong */
struct multifield *snapshot_fields(struct snapshot *c);

/** Reads a symbol, to c->word, too.  @return NULL: there is none */
const char *snapshot_word(struct snapshot *c);

bool snapshot_whole(struct snapshot *c, long long *out);
bool snapshot_count(struct snapshot *c, uint64_t *out);
bool snapshot_real(struct snapshot *c, double *out);

/** @return whether the line begins with this word; moves behind it if so */
bool snapshot_line(struct snapshot *c, const char *word);

/** Moves to the next line.  @return false: something is left on this one */
bool snapshot_end(struct snapshot *c);

/** @return the fact of an index; NULL: there is none, or the index is SNAPSHOT_NONE */
struct fact *snapshot_fact(const struct snapshot *c, long long index);

/** @return the index of a fact that is there, else SNAPSHOT_NONE */
long long snapshot_index(const struct mind *m, struct fact *fact);

/* snapshot_facts.c, snapshot_agenda.c, snapshot_state.c, snapshot_watch.c:
 * parts of the body, in this order.  Saving ends with false when something cannot be written down:
 * *why says what. */
bool snapshot_save_globals(struct mind *m, struct mu_text *out, const char **why);
bool snapshot_save_facts(struct mind *m, struct mu_text *out, const char **why);
void snapshot_save_agenda(struct mind *m, struct mu_text *out);
void snapshot_save_state(struct mind *m, struct mu_text *out);
void snapshot_save_watch(struct mind *m, struct mu_text *out);

MU_MUST_USE mu_result snapshot_load_globals(struct snapshot *c);
MU_MUST_USE mu_result snapshot_load_facts(struct snapshot *c);
MU_MUST_USE mu_result snapshot_load_agenda(struct snapshot *c);
MU_MUST_USE mu_result snapshot_load_state(struct snapshot *c);
MU_MUST_USE mu_result snapshot_load_watch(struct snapshot *c);

#endif
