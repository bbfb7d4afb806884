/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file kind.h
 * Layers of mail, and kinds of agents that take them.
 *
 * A kind names its parent and defines only what differs.  A mail of layer L goes to the kind's own
 * handlers for L, then to its parent's, until one takes it; what nobody takes is answered
 * `not-understood`.  A directive never comes here: the runtime carries it out.
 */
#ifndef MUSTER_KIND_H
#define MUSTER_KIND_H

#include "muster/agent.h"

/* What a handler did with a mail. */
enum mu_take {
    MU_PASS,    /* not mine: ask the next one */
    MU_TAKEN,   /* done, answered if an answer was wanted */
    MU_DECLINE, /* mine, and refused: the runtime answers `refuse` */
};

struct mu_layer_handler {
    uint32_t layer;           /* 0 ends a table */
    const char *performative; /* NULL: every one */
    enum mu_take (*take)(void *self, mu_agent *a, const struct mu_mail *mail);
};

/* What an agent lives through. */
enum mu_event {
    MU_ON_CREATE,
    MU_ON_RUN,
    MU_ON_ARRIVE,
    MU_ON_LEAVE,
    MU_ON_CLONE,
    MU_ON_DISPOSE,
    MU_EVENTS
};

struct mu_agent_kind {
    const char *name;
    const struct mu_agent_kind *parent;       /* NULL: mu_base_kind */
    const struct mu_layer_handler *handlers;  /* ends with layer 0; NULL: none of its own */
    void (*hooks[MU_EVENTS])(void *self, mu_agent *a); /* NULL: the parent's is called */
};

/**
 * What every agent can do: layer 1, requests to suspend, resume and dispose, which it grants;
 * layer 2, questions for its state, its groups and its services, which it answers.
 */
extern const struct mu_agent_kind mu_base_kind;

/** Makes an agent one of a kind; before it has joined others it is of mu_base_kind. */
void mu_agent_be(mu_agent *a, const struct mu_agent_kind *kind);

/** Asks the parent of the kind whose handler is running.  @return what it did */
enum mu_take mu_agent_take_parent(mu_agent *a, const struct mu_mail *mail);

/**
 * Answers a mail: to its sender, in its layer, conversation, language and ontology, in-reply-to its
 * reply-with.  Results as mu_agent_send.
 */
MU_MUST_USE mu_result mu_agent_reply(mu_agent *a, const struct mu_mail *mail,
                                     const char *performative, const char *content);

/** @return whether KQML or FIPA know that performative */
bool mu_performative_known(const char *performative);

#endif
