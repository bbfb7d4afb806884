/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/kind.h"

#include "runtime/process.h"

#include <string.h>

static const struct mu_agent_kind *parent_of(const struct mu_agent *a,
                                             const struct mu_agent_kind *kind)
{
    const struct mu_agent_kind *base = a->process->base_kind;
    if (kind == base) {
        return NULL;
    }
    return kind->parent ? kind->parent : base;
}

static const struct mu_agent_kind *kind_of(const struct mu_agent *a)
{
    return a->part.of ? a->part.of : a->process->base_kind;
}

/* @return whether a kind is its own ancestor: a second walk at half the pace would be met */
static bool descends_from_itself(const struct mu_agent *a, const struct mu_agent_kind *kind)
{
    const struct mu_agent_kind *slow = kind;
    bool is_odd = false;
    for (kind = kind ? parent_of(a, kind) : NULL; kind && kind != slow; kind = parent_of(a, kind)) {
        slow = is_odd ? parent_of(a, slow) : slow;
        is_odd = !is_odd;
    }
    return kind != NULL;
}

void mu_agent_be(mu_agent *a, const struct mu_agent_kind *kind)
{
    MU_ASSERT(!descends_from_itself(a, kind));
    a->part.of = kind;
}

/* --- mail ------------------------------------------------------------------------------------- */

static bool handler_fits(const struct mu_layer_handler *h, const struct mu_mail *mail)
{
    return h->layer == mail->layer &&
           (!h->performative || strcmp(h->performative, mail->performative) == 0);
}

/* Asks the handlers of one kind, in the order of its table. */
static enum mu_take kind_take(const struct mu_agent_kind *kind, struct mu_agent *a,
                              const struct mu_mail *mail)
{
    enum mu_take took = MU_PASS;
    for (const struct mu_layer_handler *h = kind->handlers; h && h->layer && took == MU_PASS; h++) {
        if (handler_fits(h, mail)) {
            took = h->take(a->handlers.self, a, mail);
        }
    }
    return took;
}

/* Asks a kind, its parent, and so on. */
static enum mu_take chain_take(struct mu_agent *a, const struct mu_agent_kind *kind,
                               const struct mu_mail *mail)
{
    const struct mu_agent_kind *outer = a->part.taking;
    enum mu_take took = MU_PASS;
    for (; kind && took == MU_PASS; kind = parent_of(a, kind)) {
        a->part.taking = kind;
        took = kind_take(kind, a, mail);
    }
    a->part.taking = outer;
    return took;
}

enum mu_take mu_agent_take_parent(mu_agent *a, const struct mu_mail *mail)
{
    return a->part.taking ? chain_take(a, parent_of(a, a->part.taking), mail) : MU_PASS;
}

/* @return whether the mail names this agent, not only all, a group or a role that it is in */
static bool is_personal(const struct mu_agent *a, const struct mu_mail *mail)
{
    size_t len = strlen(a->name);
    for (const char *at = mail->dst; *at;) {
        size_t word = strcspn(at, ",");
        if (word == len && memcmp(at, a->name, len) == 0) {
            return true;
        }
        at += word;
        at += *at == ',';
    }
    return false;
}

/* The runtime's own answer: its content begins with the word that was asked. */
static void answer(struct mu_agent *a, const struct mu_mail *mail, const char *performative)
{
    mu_result sent = mu_agent_reply(a, mail, performative, mail->performative);
    (void)sent; /* a full outbox: the asker's own time limit is the answer */
}

void kind_not_understood(struct mu_agent *a, const struct mu_mail *mail)
{
    if (!agent_mail_answers(mail) && is_personal(a, mail)) {
        answer(a, mail, "not-understood");
    }
}

void kind_mail(struct mu_agent *a, const struct mu_mail *mail)
{
    enum mu_take took = chain_take(a, kind_of(a), mail);
    if (took == MU_DECLINE && !agent_mail_answers(mail) &&
        (is_personal(a, mail) || mail->reply_with[0])) {
        answer(a, mail, "refuse");
    }
    if (took != MU_PASS) {
        return;
    }
    if (a->handlers.on_mail) {
        a->handlers.on_mail(a->handlers.self, a, mail);
    } else {
        kind_not_understood(a, mail);
    }
}

/* --- hooks ------------------------------------------------------------------------------------ */

/* Calls the hook of the first kind in the chain that has one. */
static void chain_event(struct mu_agent *a, const struct mu_agent_kind *kind, enum mu_event event)
{
    while (kind && !kind->hooks[event]) {
        kind = parent_of(a, kind);
    }
    if (!kind) {
        return;
    }
    const struct mu_agent_kind *outer = a->part.hooked;
    enum mu_event outer_event = a->part.event;
    a->part.hooked = kind;
    a->part.event = event;
    kind->hooks[event](a->handlers.self, a);
    a->part.hooked = outer;
    a->part.event = outer_event;
}

void kind_event(struct mu_agent *a, enum mu_event event)
{
    chain_event(a, kind_of(a), event);
}

void mu_agent_event_parent(mu_agent *a)
{
    if (a->part.hooked) {
        chain_event(a, parent_of(a, a->part.hooked), a->part.event);
    }
}

void kind_follow(struct mu_agent *a)
{
    if (a->name_state == NAME_ACCEPTED && !a->part.created) {
        a->part.created = true;
        kind_event(a, a->part.beginning);
    }
    if (a->state == MU_STANDBY) {
        a->part.begun = false; /* an agent that is put back is started again */
    } else if (a->part.created && !a->part.begun && a->state == MU_RUNNING) {
        a->part.begun = true;
        kind_event(a, MU_ON_RUN);
    }
}

void kind_end(struct mu_agent *a)
{
    if (a->part.created && !a->part.ended) {
        a->part.ended = true;
        kind_event(a, MU_ON_DISPOSE);
    }
}
