/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file kind.h
 * An agent's kind at work: which handler takes a mail, and when a hook is called.
 */
#ifndef MUSTER_RUNTIME_KIND_H
#define MUSTER_RUNTIME_KIND_H

#include "muster/kind.h"

/* The state of an agent's kind; all zero: of mu_base_kind, and nothing has happened yet. */
struct kind_part {
    const struct mu_agent_kind *of;
    const struct mu_agent_kind *taking; /* whose handler runs; NULL: none */
    const struct mu_agent_kind *hooked; /* whose hook runs; NULL: none */
    enum mu_event event;                /* of that hook */
    bool created, begun, ended;         /* these hooks have been called */
    enum mu_event beginning;            /* the first hook: MU_ON_CREATE, or that of its arrival */
};

/** Hands a mail of a layer to the kind, then to on_mail; answers mail that no handler takes. */
void kind_mail(struct mu_agent *a, const struct mu_mail *mail);

/** Says `not-understood`, unless the mail was no question to this very agent. */
void kind_not_understood(struct mu_agent *a, const struct mu_mail *mail);

/** Calls the hook for an event: the nearest kind's that has one. */
void kind_event(struct mu_agent *a, enum mu_event event);

/** The broker has accepted the agent, or its state has changed: calls the hooks that are due. */
void kind_follow(struct mu_agent *a);

/** The agent is about to go for good: calls its last hook, once. */
void kind_end(struct mu_agent *a);

#endif
