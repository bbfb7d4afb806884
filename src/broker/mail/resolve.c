/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/fields.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* Begins reply_with of a question, and so in_reply_to of its answer. */
static const char TICKET[] = "resolve-";

/* Tickets for questions outside count from here: those do not shift the tickets inside. */
static const uint64_t OUTSIDE_TICKETS = 1ull << 62;

/* --- questions to resolvers ------------------------------------------------------------------- */

enum resolve_need resolve_needs(const struct broker *b, const struct mail *m)
{
    const struct resolve *r = &b->resolve;
    const struct mu_list *queue = &r->queues[m->sender];
    bool is_address = mu_address_kind(m->letter.dst) == MU_ADDRESS_SCHEME;
    /* No address stands for the broker, and a resolver's answers must not wait for each other. */
    bool follows = queue->count > 0 && strcmp(m->letter.dst, "broker") != 0;
    if (!follows && !(is_address && view_resolver(b, m->letter.dst) != MU_NONE)) {
        return RESOLVE_NOTHING;
    }
    enum quota_side side = scope_account(b->registry.agents[m->sender].scope);
    bool full = queue->count == MU_RESOLVE_SENDER_MAX || r->side_count[side] == MU_RESOLVE_MAX;
    return full ? RESOLVE_FULL : RESOLVE_WAIT;
}

/* --- waiting ---------------------------------------------------------------------------------- */

static void resolver_ask(struct broker *b, uint32_t index)
{
    char ticket[MU_FIELD_MAX + 1];
    struct resolve *r = &b->resolve;
    struct resolve_wait *w = &r->waits[index];
    bool inside = view_inside(b, w->resolver);
    w->ticket = (inside ? 0 : OUTSIDE_TICKETS) + ++r->tickets[inside];
    w->until_ns =
        w->since_ns + (clock_by_steps(&b->clock) ? RESOLVE_PATIENCE_STEPS * b->clock.step_ns
                                                 : RESOLVE_PATIENCE_MS * 1000000ull);
    r->soonest_ns = w->until_ns < r->soonest_ns ? w->until_ns : r->soonest_ns;
    r->asked++;
    (void)mu_list_append(&r->waits_asked, MU_LINKS(r->waits, asked), index);
    struct mu_text t = answer_begin(b, "resolve");
    mu_fields_add_string(&t, w->mail->letter.dst);
    mu_fields_add(&t, w->mail->letter.src);
    snprintf(ticket, sizeof ticket, "%s%" PRIu64, TICKET, w->ticket);
    muster_Mail question = {.performative = sample_text("resolve"), .reply_with = ticket};
    answer_post(b, REGISTRY_BROKER, w->resolver, &question);
}

void resolve_wait(struct broker *b, struct mail *m)
{
    struct resolve *r = &b->resolve;
    uint32_t index = mu_pool_take(&r->pool);
    MU_ASSERT(index != MU_NONE);
    r->side_count[m->side]++;
    struct resolve_wait *w = &r->waits[index];
    *w =
        (struct resolve_wait){.mail = m, .since_ns = clock_mail_ns(&b->clock), .resolver = MU_NONE};
    (void)mu_list_append(&r->queues[m->sender], MU_LINKS(r->waits, link), index);
    if (mu_address_kind(m->letter.dst) == MU_ADDRESS_SCHEME) {
        w->resolver = view_resolver(b, m->letter.dst);
    }
    if (w->resolver != MU_NONE) {
        resolver_ask(b, index);
    }
}

struct mail *resolve_next_ready(struct broker *b, uint32_t sender, struct mail **answer)
{
    struct resolve *r = &b->resolve;
    uint32_t index = mu_list_first(&r->queues[sender]);
    if (index == MU_NONE || mu_list_has(MU_LINKS(r->waits, asked), index)) {
        return NULL;
    }
    struct resolve_wait w = r->waits[index];
    (void)mu_list_take(&r->queues[sender], MU_LINKS(r->waits, link));
    mu_pool_give(&r->pool, index);
    r->side_count[w.mail->side]--;
    ledger_settle(b, w.mail);
    uint64_t waited_ns = clock_mail_ns(&b->clock) - w.since_ns;
    if (w.mail->letter.ttl_ns > 0) { /* 0 would be for ever */
        uint64_t ttl_ns = w.mail->letter.ttl_ns;
        w.mail->letter.ttl_ns = ttl_ns > waited_ns ? ttl_ns - waited_ns : 1;
    }
    *answer = w.answer;
    return w.mail;
}

/* It is known, or (answer NULL) will never be, for which agents an address stands.  @return whose
 * mail */
static uint32_t wait_answer(struct broker *b, uint32_t index, struct mail *answer)
{
    struct resolve *r = &b->resolve;
    struct resolve_wait *w = &r->waits[index];
    (void)mu_list_remove(&r->waits_asked, MU_LINKS(r->waits, asked), index);
    w->answer = answer;
    if (answer) {
        pool_keep(answer);
    }
    return w->mail->sender;
}

/* --- answers ---------------------------------------------------------------------------------- */

bool resolve_is_answer(const struct mail *m)
{
    return m->letter.layer == 2 && strncmp(m->letter.in_reply_to, TICKET, sizeof TICKET - 1) == 0;
}

/* @return the mail that waits for this answer, or MU_NONE */
static uint32_t wait_find(const struct resolve *r, const struct mail *m)
{
    char *end;
    const char *digits = m->letter.in_reply_to + sizeof TICKET - 1;
    uint64_t ticket = strtoull(digits, &end, 10);
    if (digits[0] < '0' || digits[0] > '9' || *end != '\0') {
        return MU_NONE;
    }
    uint32_t index = mu_list_first(&r->waits_asked);
    while (index != MU_NONE && r->waits[index].ticket != ticket) {
        index = mu_list_next(MU_LINKS(r->waits, asked), index);
    }
    return index != MU_NONE && r->waits[index].resolver == m->sender ? index : MU_NONE;
}

/* @return whether the content is nothing but symbols and strings */
static bool answer_is_fields(const char *content)
{
    char field[MU_NAME_MAX + 1];
    struct mu_text read = mu_text_in(field, sizeof field);
    while (!mu_fields_end(content)) {
        const char *before = content;
        (void)mu_fields_next(&content, &read); /* what is too long is a field all the same */
        if (content == before) {
            return false;
        }
    }
    return true;
}

uint32_t resolve_take_answer(struct broker *b, struct mail *m)
{
    uint32_t index = wait_find(&b->resolve, m);
    /* In a list of receivers it could have waited itself. */
    if (index == MU_NONE || strcmp(m->letter.dst, "broker") != 0) {
        b->resolve.refused++;
        return MU_NONE;
    }
    bool good = strcmp(m->letter.performative, "inform") == 0;
    if (good && !answer_is_fields(m->letter.content)) {
        b->counters.malformed++;
        good = false;
    }
    return wait_answer(b, index, good ? m : NULL);
}

/* --- time ------------------------------------------------------------------------------------- */

uint32_t resolve_overdue(struct broker *b, uint64_t mail_ns)
{
    struct resolve *r = &b->resolve;
    if (mail_ns < r->soonest_ns) {
        return MU_NONE;
    }
    uint64_t soonest_ns = UINT64_MAX;
    MU_LIST_EACH (i, &r->waits_asked, MU_LINKS(r->waits, asked)) {
        if (r->waits[i].until_ns <= mail_ns) {
            return wait_answer(b, i, NULL);
        }
        soonest_ns = r->waits[i].until_ns < soonest_ns ? r->waits[i].until_ns : soonest_ns;
    }
    r->soonest_ns = soonest_ns;
    return MU_NONE;
}
