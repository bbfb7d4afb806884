/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file directory.h
 * A process's copy of the groups and the yellow pages, which the broker keeps up to date, and the
 * standing queries of its agents.
 *
 * The broker sends an offer as it is to be shown: not offered also when its agent is absent or its
 * lease is over.  Here nothing depends on a clock.
 */
#ifndef MUSTER_RUNTIME_DIRECTORY_H
#define MUSTER_RUNTIME_DIRECTORY_H

#include "core/attributes.h"
#include "core/pairs.h"
#include "muster/directory.h"
#include "wire.h"

/* A standing query. */
struct directory_watch {
    mu_agent *agent; /* NULL: free */
    char text[MU_QUERY_MAX + 1];
    struct mu_query query;
    bool fresh; /* has not been told of the services that are there */
    uint64_t told[(MU_SERVICES_MAX + 63) / 64]; /* a bit for each line */
};

/* Where the last search stood: the next one mostly goes on from there. */
struct directory_cursor {
    bool begun;
    char text[MU_QUERY_MAX + 1];
    struct mu_query query;
    uint64_t version; /* of the offers */
    uint32_t place;   /* in their order, of: */
    size_t index;     /* the index-th line that fits */
};

struct directory {
    struct mu_pairs groups;   /* (group, "") */
    bool *said;               /* by index of groups: it is there even without members */
    struct mu_pairs members;  /* (group, agent) */
    struct mu_pairs offers;   /* (service, agent) */
    struct mu_service *lines; /* by index of offers */
    uint64_t version;         /* of the offers */
    struct directory_cursor *cursor;
    struct directory_watch *watches; /* MU_WATCHES_MAX of them */
    uint32_t watches_count;
    bool fresh; /* one of them is */
};

/** Takes memory at start-up. */
void directory_init(struct directory *d);

/**
 * Forgets all: other pages will come.
 *
 * @param silently  standing queries are not told of services that go: they will be told of all that
 * are there
 */
void directory_clear(struct directory *d, bool silently);

/** Takes in a change; a line too many is left out. */
void directory_set_membership(struct directory *d, const muster_Membership *line);
void directory_set_offer(struct directory *d, const muster_Offer *line);

/** The standing queries of an agent that leaves end. */
void directory_forget(struct directory *d, const mu_agent *a);

/** Tells standing queries that are new of the services that are there. */
void directory_settle(struct directory *d);

/** @return whether a mail is the broker's answer to a change of the runtime's own; it is dealt with
 */
bool directory_take_answer(mu_agent *a, const muster_Mail *mail);

#endif
