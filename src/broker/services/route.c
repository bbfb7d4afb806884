/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/services.h"

#include "broker/control/parts.h"
#include "core/address.h"

#include <string.h>

/* @return whether a resolver names its receivers */
static bool mail_is_to_scheme(const struct mail *m)
{
    return m->only == MU_NONE && mu_address_kind(m->letter.dst) == MU_ADDRESS_SCHEME;
}

/* @return whether the mail is for an agent inside, or changes what is said of one */
static bool meets_run(struct broker *b, const struct mail *m)
{
    struct recipients to;
    if (mail_is_to_scheme(m)) {
        return view_has_resolver(b, m->letter.dst); /* only members are asked */
    }
    recipients_of_mail(b, m, &to);
    bool meets = false;
    for (uint32_t i = 0; i < to.count && !meets; i++) {
        uint32_t agent = to.agents[i];
        if (registry_is_own(agent)) { /* what changes the broker takes effect between steps, too */
            meets = m->letter.layer == 0 || recipients_has_member_change(b, m);
        } else {
            meets = scope_is_inside(registry_scope(&b->registry, agent)) ||
                    steps_keeps_before(b, m, agent);
        }
    }
    return meets;
}

void route_from_outside(struct broker *b, struct mail *m)
{
    if (!clock_by_steps(&b->clock) || !meets_run(b, m)) {
        (void)route_mail(b, m);
    } else if (!steps_keep(b, m, true)) {
        outcome_turn_away(b, m);
    }
}

/* --- on its way ------------------------------------------------------------------------------- */

/* The disk has failed since it was admitted. */
static void mail_unstored(struct broker *b, struct mail *m, const struct recipients *to)
{
    b->counters.no_store += to->count;
    outcome_refuse(b, m, to->unknown, muster_OUTCOME_NO_STORE);
}

static bool mail_is_answer(uint32_t own, const struct mail *m)
{
    bool asks_state = m->letter.layer == 2 && strcmp(m->letter.performative, "state") == 0;
    return own == REGISTRY_BROKER && m->letter.layer != 0 && !asks_state && resolve_is_answer(m);
}

static void mails_pump(struct broker *b, uint32_t sender);

/* The broker's own desks take it. */
static void desks_take(struct broker *b, struct mail *m, const struct recipients *to)
{
    for (uint32_t i = 0; i < to->count; i++) {
        uint32_t own = to->agents[i];
        if (!registry_is_own(own)) {
            continue;
        }
        b->counters.delivered++;
        if (mail_is_answer(own, m)) {
            mails_pump(b, resolve_take_answer(b, m));
        } else {
            desk_take(b, own, m);
        }
    }
}

/* Goes on with a mail that need not wait for an address, or no longer.
 * @param names  fields of content: the agents that SCHEME:REST stands for; NULL: not known
 * @return as route_mail */
static bool mail_go_on(struct broker *b, struct mail *m, const char *names)
{
    struct recipients to;
    if (names) {
        recipients_of_answer(b, names, m->sender, &to);
    } else {
        recipients_of_mail(b, m, &to);
        to.unknown = mail_is_to_scheme(m) ? 1 : to.unknown;
    }
    m->order = ++b->orders;
    if (m->letter.layer == 0) {
        to.refused = guard_sift(b, m, to.agents, &to.count);
        if (to.refused > 0) {
            ledger_alert(b, ALERT_REFUSED, REGISTRY_BROKER, m->sender);
        }
    }
    b->counters.sent += to.count + to.unknown + to.refused;
    b->counters.unknown_name += to.unknown;
    struct delivered done;
    bool goes_on = to.refused == 0 || to.count > 0;
    if (m->letter.level != muster_LEVEL_RAM && !journal_takes(b)) {
        mail_unstored(b, m, &to);
    } else if (deliver_put(b, m, &to, &done)) {
        if (m->unsettled >= MULTICAST_PLACES_MIN) {
            multicast_note(b, m);
        }
        desks_take(b, m, &to);
        deliver_conclude(b, m, &to, &done);
    }
    return goes_on;
}

/* Routes the mails of a sender that wait for a resolver's answer no longer. */
static void mails_pump(struct broker *b, uint32_t sender)
{
    struct mail *m, *answer;
    while (sender != MU_NONE && (m = resolve_next_ready(b, sender, &answer))) {
        (void)mail_go_on(b, m, answer ? answer->letter.content : NULL);
        if (answer) {
            pool_release(&b->pool, answer);
        }
    }
}

bool route_mail(struct broker *b, struct mail *m)
{
    bool plain = resolve_is_plain(&b->resolve, m);
    enum resolve_need need = plain ? RESOLVE_NOTHING : resolve_needs(b, m);
    if (need == RESOLVE_NOTHING) {
        return mail_go_on(b, m, NULL);
    }
    if (need == RESOLVE_FULL) {
        outcome_turn_away(b, m);
    } else if (ledger_charge(b, m, 1)) {
        resolve_wait(b, m);
    } else {
        b->counters.sent++;
        outcome_refuse(b, m, 0, muster_OUTCOME_BOX_FULL);
    }
    return true;
}

void route_resolve_expire(struct broker *b, uint64_t mail_ns)
{
    for (uint32_t s; (s = resolve_overdue(b, mail_ns)) != MU_NONE;) {
        mails_pump(b, s);
    }
}

void route_resolve_give_up(struct broker *b)
{
    for (uint32_t s; (s = resolve_give_up(b)) != MU_NONE;) {
        mails_pump(b, s);
    }
}
