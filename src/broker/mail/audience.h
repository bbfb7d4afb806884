/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file audience.h
 * Whom a mail is for: names, a kind, a group, or whom a resolver has named.
 */
#ifndef MUSTER_BROKER_AUDIENCE_H
#define MUSTER_BROKER_AUDIENCE_H

#include "broker/base/store.h"
#include "broker/names/registry.h"

struct broker;

/* Whom a mail is for, each once; too large to be cleared for every mail. */
struct audience {
    uint32_t agents[REGISTRY_MAX];
    uint32_t count;
    uint32_t unknown; /* names that nobody ever had */
    uint32_t refused; /* those whom the sender may not direct: not among the agents */
    uint32_t veiled;  /* those outside the lock step that the sender is in; set by posting_book */
};

/**
 * Finds whom a letter is for.  Of an address SCHEME:REST nobody is found; it is an unknown name if
 * there is nobody to ask about it.
 */
void audience_of_letter(struct broker *b, const muster_Mail *letter, uint32_t sender,
                        struct audience *to);

/** Finds whom a mail is for: its one receiver, if another broker has named that, or the letter's.
 */
void audience_of_mail(struct broker *b, const struct mail *m, struct audience *to);

/** Finds the bearers of names that are joined by commas, the absent ones, too. */
void audience_of_names(struct broker *b, const char *names, uint32_t sender, struct audience *to);

/**
 * Finds those whom a resolver has named: the sender, and who is nobody, are left out; of the lock
 * step nobody can be among them but when a step ends.
 *
 * @param names  fields of content
 * @param to     out: one unknown name, if nobody is left: an address that nobody fits
 */
void audience_of_answer(struct broker *b, const char *names, uint32_t sender, struct audience *to);

/**
 * @return whether the agent is outside a lock step that the mail's sender is in: what becomes of
 *         the mail there, and when, is no business of those inside
 */
bool audience_veils(const struct broker *b, const struct mail *m, uint32_t agent);

/** Takes those outside out of it: they are not reached. */
void audience_unveil(const struct broker *b, const struct mail *m, struct audience *to);

#endif
