/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_capsule.h
 * A mind as text, and back: what the files of the capsule share.
 *
 * The body of a capsule is lines: a word that says what the line is about, then numbers and fields.
 * A field bears its type: i7, f0x1.8p+1, y"symbol", s"string", n"instance", a12 (the fact of that
 * index, a-1: one that is no more).
 */
#ifndef MUSTER_AGENT_CLIPS_CAPSULE_H
#define MUSTER_AGENT_CLIPS_CAPSULE_H

#include "mind/clips_mind.h"

enum { CLIPS_CAPSULE_NONE = -1, CLIPS_CAPSULE_KEY_MAX = 1024 };

/* A capsule that is read, from its first line to its last. */
struct capsule {
    struct mind *mind;
    const char *at;
    struct mu_fault *fault;
    int line;
    const char *word; /* that was read last: a symbol */
};

/* snapshot.c */

/** Writes a mind down: as mind_save. */
MU_MUST_USE mu_result snapshot_save(struct mind *m, struct mu_text *out, struct mu_fault *fault);

/** @return MU_OK: the text is a whole snapshot of this version */
MU_MUST_USE mu_result snapshot_check(const char *text, size_t len, struct mu_fault *fault);

/** Makes a fresh mind what a checked snapshot says: as mind_restore.  @param name  out: whose it is
 */
MU_MUST_USE mu_result snapshot_load(struct mind *m, const char *text, struct mu_fault *fault,
                                    char name[MU_NAME_MAX + 1]);

/* clips_capsule_text.c: the fields */

/** @return MU_FAULT_FILE, with the line and what is wrong there */
mu_result clips_capsule_wrong(struct capsule *c, const char *what);

/** Adds a space and a field.  @return false: it is of a type that cannot be written down */
bool clips_capsule_add(struct mu_text *out, unsigned short type, const void *value);

/** Adds a space and a symbol. */
void clips_capsule_add_word(struct mu_text *out, const char *word);

/** Adds a space and a number, to the last bit. */
void clips_capsule_add_real(struct mu_text *out, double x);

/** @return whether the line goes on with another field, before its end or a parenthesis */
bool clips_capsule_more(const struct capsule *c);

/** Reads one field; its value is not installed.  @return false: there is none, or it is wrong */
bool clips_capsule_field(struct capsule *c, struct field *out);

/** Reads the fields up to the line's end or a parenthesis.  @return NULL: one is wrong */
struct multifield *clips_capsule_fields(struct capsule *c);

/** Reads a symbol, to c->word, too.  @return NULL: there is none */
const char *clips_capsule_word(struct capsule *c);

bool clips_capsule_whole(struct capsule *c, long long *out);
bool clips_capsule_count(struct capsule *c, uint64_t *out);
bool clips_capsule_real(struct capsule *c, double *out);

/** @return whether the line begins with this word; moves behind it if so */
bool clips_capsule_line(struct capsule *c, const char *word);

/** Moves to the next line.  @return false: something is left on this one */
bool clips_capsule_end(struct capsule *c);

/** @return the fact of an index; NULL: there is none, or the index is CLIPS_CAPSULE_NONE */
struct fact *clips_capsule_fact(const struct capsule *c, long long index);

/** @return the index of a fact that is there, else CLIPS_CAPSULE_NONE */
long long clips_capsule_index(const struct mind *m, struct fact *fact);

/* clips_capsule_facts.c, clips_capsule_agenda.c, clips_capsule_state.c, clips_capsule_watch.c:
 * parts of the body, in this order.  Saving ends with false when something cannot be written down:
 * *why says what. */
bool clips_capsule_save_globals(struct mind *m, struct mu_text *out, const char **why);
bool clips_capsule_save_facts(struct mind *m, struct mu_text *out, const char **why);
void clips_capsule_save_agenda(struct mind *m, struct mu_text *out);
void clips_capsule_save_state(struct mind *m, struct mu_text *out);
void clips_capsule_save_watch(struct mind *m, struct mu_text *out);

MU_MUST_USE mu_result clips_capsule_load_globals(struct capsule *c);
MU_MUST_USE mu_result clips_capsule_load_facts(struct capsule *c);
MU_MUST_USE mu_result clips_capsule_load_agenda(struct capsule *c);
MU_MUST_USE mu_result clips_capsule_load_state(struct capsule *c);
MU_MUST_USE mu_result clips_capsule_load_watch(struct capsule *c);

#endif
