/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/membership.h"

#include "broker/control/parts.h"

#include <string.h>

static const uint64_t PAUSE_NS = 250000000;

/* So long a name that has ended keeps its index: the other brokers hear of its end. */
static const uint64_t LINGER_NS = 2000000000;

/* --- holders of an index ---------------------------------------------------------------------- */

static void hold(struct broker *b, uint32_t agent)
{
    if (agent < REGISTRY_MAX) { /* else none's */
        b->retirement.held[agent] = true;
    }
}

/* All mail that lives, in a box or not, and what a step or a resolver is awaited for. */
static void hold_mails(struct broker *b)
{
    uint32_t place = 0;
    for (const struct mail *m; (m = pool_each(&b->pool, &place));) {
        hold(b, m->sender);
        hold(b, m->payer);
        hold(b, m->only);
        hold(b, m->kept_for);
        MU_LIST_EACH (post, &m->posts, MU_LINKS(b->mailbox.posts, links[LINKS_MAIL])) {
            hold(b, b->mailbox.posts[post].agent);
        }
    }
    for (uint32_t i = 0; i < b->steps.active_count; i++) {
        hold(b, b->steps.active[i]);
    }
    MU_LIST_EACH (i, &b->resolve.waits_asked, MU_LINKS(b->resolve.waits, asked)) {
        hold(b, b->resolve.waits[i].resolver);
    }
}

static void hold_snapshots(struct broker *b)
{
    const struct snapshots *d = &b->snapshots;
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        const struct snapshot *c = &d->snapshots[i];
        if (c->phase != SNAPSHOT_FREE || c->unsaved) {
            hold(b, c->agent);
            hold(b, c->asker);
            hold(b, c->host);
        }
    }
    for (uint32_t i = 0; i < d->words_count; i++) {
        hold(b, d->words[i].asker);
        hold(b, d->words[i].host);
    }
}

static void hold_probes(struct broker *b)
{
    const struct probes *g = &b->probes;
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        if (g->at[i].used) {
            hold(b, g->at[i].asker);
            hold(b, g->at[i].agent);
        }
    }
    for (uint32_t i = 0; i < g->words_count; i++) {
        hold(b, g->words[i].asker);
        hold(b, g->words[i].agent);
    }
}

static void hold_groups(struct broker *b)
{
    const struct lines *g = &b->pages.groups;
    MU_LIST_EACH (line, &g->changes.list, MU_LINKS(g->changes.lines, link)) {
        if (g->at[line].holds || g->at[line].holds_inside) {
            hold(b, registry_find(&b->registry, mu_pairs_second(&g->pairs, line)));
        }
    }
}

static void hold_alerts(struct broker *b)
{
    const struct alerts *e = &b->alerts;
    MU_LIST_EACH (i, &e->queue, MU_LINKS(e->all, link)) {
        hold(b, e->all[i].agent);
        hold(b, e->all[i].sender);
    }
}

static bool is_held_beyond(const struct broker *b, uint32_t agent)
{
    const struct federation *l = &b->federation;
    bool held = remote_pauses(l, agent);
    for (uint32_t i = 0; i < l->peers_count && !held; i++) {
        held = l->peers[i].routes[agent].present ||
               mu_list_has(MU_LINKS(l->peers[i].boxes, ack), agent);
    }
    return held;
}

static bool is_absent(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    uint64_t wall_ns = clock_wall_ns(&b->clock);
    bool is_nobody = a->name[0] != '\0' && a->process == MU_NONE && a->claims.count == 0;
    const struct quota_use *outside = &b->quotas.senders[QUOTA_OUTSIDE][agent];
    const struct quota_use *inside = &b->quotas.senders[QUOTA_INSIDE][agent];
    bool is_idle = !a->unsaved && outside->mails + inside->mails == 0;
    return is_nobody && is_idle && !names_is_held(b, agent) && wall_ns > a->since_wall_ns &&
           wall_ns - a->since_wall_ns >=
               (a->named == NAMED_ENDED ? LINGER_NS : b->retirement.expiry_ns);
}

static void hold_all(struct broker *b)
{
    memset(b->retirement.held, 0, b->registry.count * sizeof *b->retirement.held);
    hold_mails(b);
    hold_snapshots(b);
    hold_probes(b);
    hold_groups(b);
    hold_alerts(b);
}

/* --- agents that were disposed of ------------------------------------------------------------- */

/* Its mail is answered: what another broker may have had already, by that broker. */
static void box_clear(struct broker *b, uint32_t agent)
{
    const struct box *box = &b->mailbox.boxes[agent];
    bool beyond = b->registry.agents[agent].is.home[0] != '\0';
    for (int list = POST_HELD; box->begun && list <= POST_FLIGHT; list++) {
        uint32_t post = MU_NONE;
        while ((post = mu_list_first(&box->lists[list].posts)) != MU_NONE) {
            struct mail *m = b->mailbox.posts[post].mail;
            bool passes = list == POST_FLIGHT && beyond;
            if (list == POST_FLIGHT) {
                (void)mailbox_pop(&b->mailbox, agent);
            } else {
                mailbox_withdraw(&b->mailbox, post);
            }
            b->federation.count.passed_on += passes;
            b->counters.dropped += !passes;
            mail_meets(m, passes ? FATE_PASSED_ON : FATE_DROPPED);
            outcome_settle(b, m);
        }
    }
}

/* Its groups or services go, as the broker at which it lived says to the others. */
static void lines_clear(struct broker *b, struct lines *l, const char *name, request_change *leave)
{
    struct said said = view_said(b);
    for (uint32_t i = 0; i < l->pairs.count; i++) {
        uint32_t line = l->pairs.order[i];
        if (strcmp(mu_pairs_second(&l->pairs, line), name) == 0) {
            (void)leave(l, mu_pairs_first(&l->pairs, line), name, &said);
        }
    }
}

static void subscriptions_clear(struct broker *b, const char *name)
{
    struct subscriptions *all = &b->pages.subscriptions;
    for (uint32_t i = all->count; i-- > 0;) {
        if (strcmp(subscriptions_at(all, i)->agent, name) == 0) {
            subscriptions_remove(all, i);
        }
    }
}

static void name_clear(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (snapshots_epoch(b, agent) > 0) { /* it is on its way */
        registry_named_on(&b->registry, agent, NAMED_BORNE);
        return;
    }
    box_clear(b, agent);
    if (a->is.home[0] == '\0') {
        lines_clear(b, &b->pages.groups, a->name, groups_leave);
        lines_clear(b, &b->pages.services, a->name, services_withdraw);
        notify_tell(b);
    }
    subscriptions_clear(b, a->name);
    receipts_drop(&b->receipts, agent, receipts_count(&b->receipts, agent));
    names_bearer_on(&b->registry, agent, BEARER_FORGETS);
    registry_named_on(&b->registry, agent, NAMED_CLEARED);
    (void)journal_end(b, agent);
    registry_touch(&b->registry, agent);
}

void retire_disposed(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    bool ends = a->process == MU_NONE && a->named != NAMED_LASTS;
    b->retirement.ending += ends;
    if (ends && a->named != NAMED_ENDED && !clock_by_steps(&b->clock)) {
        name_clear(b, agent);
    }
}

/* --- the end ---------------------------------------------------------------------------------- */

static void agent_end(struct broker *b, uint32_t agent)
{
    receipts_drop(&b->receipts, agent, receipts_count(&b->receipts, agent));
    mailbox_end(&b->mailbox, agent);
    limiter_told(&b->bad_news, agent, b->clock.now_ns);
    limiter_told(&b->good_news, agent, b->clock.now_ns);
    for (uint32_t i = 0; i < b->federation.peers_count; i++) {
        b->federation.peers[i].boxes[agent].taken = 0;
    }
    registry_remove(&b->registry, agent);
    announce_agent(b, agent);
    b->retirement.ended++;
}

/* An agent beyond other brokers that had no place may have one now. */
static void missed_ask(struct broker *b)
{
    for (uint32_t i = 0; i < b->federation.peers_count; i++) {
        const struct peer *p = &b->federation.peers[i];
        uint32_t place = p->state == PEER_THERE ? processes_find(&b->processes, p->place) : MU_NONE;
        if (place != MU_NONE) {
            processes_call_roll(&b->processes, place);
        }
    }
    b->federation.missed = false;
}

void retire_tick(struct broker *b)
{
    struct retirement *t = &b->retirement;
    if (retire_deadline_ns(b) > b->clock.now_ns) {
        return;
    }
    t->next_ns = b->clock.now_ns + PAUSE_NS;
    t->ending = 0;
    uint64_t ended_before = t->ended;
    bool crowded = registry_is_crowded(&b->registry);
    hold_all(b);
    for (uint32_t agent = REGISTRY_OWN; agent < b->registry.count; agent++) {
        const struct agent *a = &b->registry.agents[agent];
        if ((crowded || a->named == NAMED_ENDED) && !t->held[agent] && is_absent(b, agent) &&
            !is_held_beyond(b, agent) && journal_end(b, agent)) {
            agent_end(b, agent);
        } else {
            retire_disposed(b, agent);
        }
    }
    if (b->federation.missed && t->ended > ended_before) {
        missed_ask(b);
    }
}

uint64_t retire_deadline_ns(const struct broker *b)
{
    bool wanted = (b->retirement.ending > 0 || registry_is_crowded(&b->registry)) &&
                  !clock_by_steps(&b->clock);
    return wanted ? b->retirement.next_ns : UINT64_MAX;
}
