/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/check.h"

#include "bus/bus.h"
#include "bus/check_fields.h"

/* Names of rules that fired in one step: MU_FIRINGS_PER_STEP symbols, in bytes. */
enum { RULES_TEXT_MAX = 64 * 1024 };

/* Counters of one part of a broker. */
enum { PART_COUNTERS_MAX = 64 };
/* A line of the white pages, in bytes. */
enum { LINE_TEXT_MAX = 511 };

/* to: whether it needs a receiver */
static bool letter_ok(const muster_Mail *m, bool to)
{
    const char *const fields[] = {m->performative, m->language,    m->ontology,
                                  m->reply_with,   m->in_reply_to, m->conversation};
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (!text_fits(fields[i], MU_FIELD_MAX)) {
            return false;
        }
    }
    return is_name(m->src) && is_count(m->seq) && text_fits(m->dst, MU_DST_MAX) &&
           (m->dst[0] != '\0' || !to) && m->priority >= -1 && m->priority <= 1 &&
           (unsigned)m->level <= muster_LEVEL_SYNCED && text_fits(m->content, MU_CONTENT_MAX);
}

static bool mail_ok(const muster_Mail *m)
{
    return letter_ok(m, true);
}

bool check_mails(const muster_Mail *mails, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!mail_ok(&mails[i])) {
            return false;
        }
    }
    return true;
}

/* What goes out again may be a number alone. */
static bool sent_ok(const muster_Mail *mails, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!letter_ok(&mails[i], !mails[i].again)) {
            return false;
        }
    }
    return true;
}

static bool act_ok(const muster_Act *a)
{
    /* A speed that is no number is the simulator's to refuse: the answer to the step still counts.
     */
    return is_name(a->agent) && text_fits(a->rules, RULES_TEXT_MAX) &&
           text_fits(a->goal, MU_FIELD_MAX) && text_fits(a->diary, MU_NOTE_MAX) &&
           a->mails._length <= MU_OUTBOX_MAX && sent_ok(a->mails._buffer, a->mails._length);
}

static bool acks_ok(const muster_Ack *acks, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!is_name(acks[i].box)) {
            return false;
        }
    }
    return true;
}

/* A name that is not one is passed on, so that the broker can say why it refuses it, and goes on
 * with the other agents of the process. */
static bool entry_ok(const muster_Entry *e)
{
    return e->name && text_fits(e->home, MU_FIELD_MAX) &&
           (!e->via || text_fits(e->via, MU_FIELD_MAX)) &&
           (!e->host || text_fits(e->host, MU_FIELD_MAX)) &&
           (!e->reason || text_fits(e->reason, MU_FIELD_MAX)) && e->last_seq <= INT64_MAX;
}

bool check_registration(const void *sample)
{
    const muster_Registration *r = sample;
    if (!is_process(r->process) || r->part >= MU_PARTS_MAX || !text_fits(r->broker, MU_FIELD_MAX) ||
        !text_fits(r->host, MU_FIELD_MAX) || r->agents._length > MU_PART_AGENTS) {
        return false;
    }
    for (uint32_t i = 0; i < r->agents._length; i++) {
        if (!entry_ok(&r->agents._buffer[i])) {
            return false;
        }
    }
    return true;
}

static bool trips_ok(const muster_Trip *trips, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const muster_Trip *t = &trips[i];
        bool is_new = t->word == muster_TRIP_NEW;
        if ((unsigned)t->word > muster_TRIP_NEW || !text_fits(t->host, MU_NAME_MAX) ||
            (unsigned)t->state > muster_STATE_ABSENT || (is_new && !is_name(t->asker)) ||
            !text_fits(t->asker, MU_NAME_MAX) || !text_fits(t->process, MU_PROCESS_MAX) ||
            !text_fits(t->reason, MU_FIELD_MAX) || !text_fits(t->text, MU_CAPSULE_MAX - 1) ||
            (t->word != muster_TRIP_WANTED && !is_name(t->agent))) {
            return false;
        }
    }
    return true;
}

static bool glances_ok(const muster_Glance *glances, uint32_t count)
{
    for (uint32_t i = 0; i < count && count <= MU_GLANCES_MAX; i++) {
        const muster_Glance *g = &glances[i];
        size_t most = g->word == muster_GLANCE_ASK ? MU_GLANCE_LINE_MAX : MU_GLANCE_BYTES_MAX - 1;
        if ((unsigned)g->word > muster_GLANCE_DECLINED || !is_name(g->asker) ||
            !is_count(g->number) || !is_name(g->agent) || !text_fits(g->text, most)) {
            return false;
        }
    }
    return count <= MU_GLANCES_MAX;
}

bool check_acts(const muster_Act *acts, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!act_ok(&acts[i])) {
            return false;
        }
    }
    return true;
}

bool check_up(const void *sample)
{
    const muster_Up *u = sample;
    if (!is_process(u->process) || u->acts._length > MU_LOCAL_AGENTS_MAX ||
        u->acks._length > MU_LOCAL_AGENTS_MAX || !trips_ok(u->trips._buffer, u->trips._length) ||
        !glances_ok(u->glances._buffer, u->glances._length)) {
        return false;
    }
    return check_acts(u->acts._buffer, u->acts._length) &&
           acks_ok(u->acks._buffer, u->acks._length);
}

static bool member_ok(const muster_Member *m)
{
    return is_name(m->name) && text_fits(m->process, MU_PROCESS_MAX) &&
           text_fits(m->broker, MU_FIELD_MAX) && text_fits(m->host, MU_FIELD_MAX) &&
           (!m->reason || text_fits(m->reason, MU_FIELD_MAX));
}

static bool members_ok(const muster_Member *members, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!member_ok(&members[i])) {
            return false;
        }
    }
    return true;
}

static bool membership_ok(const muster_Membership *m)
{
    return is_name(m->group) && text_fits(m->agent, MU_NAME_MAX) &&
           (m->agent[0] == '\0' || mu_name_valid(m->agent)) && text_fits(m->origin, MU_FIELD_MAX);
}

static bool offer_ok(const muster_Offer *o)
{
    return is_name(o->service) && is_name(o->agent) &&
           text_fits(o->attributes, MU_ATTRIBUTES_MAX) && text_fits(o->origin, MU_FIELD_MAX);
}

static bool pages_ok(const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->memberships._length; i++) {
        if (!membership_ok(&d->memberships._buffer[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < d->offers._length; i++) {
        if (!offer_ok(&d->offers._buffer[i])) {
            return false;
        }
    }
    return members_ok(d->members._buffer, d->members._length);
}

bool check_page(const void *sample)
{
    const muster_Page *p = sample;
    bool fits = is_process(p->broker);
    for (uint32_t i = 0; fits && i < p->lines._length; i++) {
        fits = text_fits(p->lines._buffer[i], LINE_TEXT_MAX);
    }
    return fits;
}

/* A process that unpacks a circular looks for its own seat among those that ascend. */
static bool circular_ok(const muster_Delivery *d)
{
    uint32_t boxes = d->seats._length;
    if (d->serials._length != boxes || d->slots._length != boxes || d->numbers._length != boxes) {
        return false;
    }
    for (uint32_t i = 0; i < boxes; i++) {
        if ((i > 0 && d->seats._buffer[i] < d->seats._buffer[i - 1]) ||
            !is_count(d->numbers._buffer[i]) || !is_count(d->serials._buffer[i])) {
            return false;
        }
    }
    return d->letters._length <= BUS_CIRCULAR_LETTERS &&
           check_mails(d->letters._buffer, d->letters._length);
}

bool check_delivery(const void *sample)
{
    const muster_Delivery *d = sample;
    if (!is_process(d->process) || !text_fits(d->broker, MU_FIELD_MAX)) {
        return false;
    }
    for (uint32_t i = 0; i < d->parcels._length; i++) {
        const muster_Parcel *p = &d->parcels._buffer[i];
        if (!is_name(p->box) || !is_count(p->number) || !mail_ok(&p->letter)) {
            return false;
        }
    }
    for (uint32_t i = 0; i < d->receipts._length; i++) {
        if (!is_name(d->receipts._buffer[i].agent)) {
            return false;
        }
    }
    for (uint32_t i = 0; i < d->verdicts._length; i++) {
        const muster_Verdict *v = &d->verdicts._buffer[i];
        if (!text_fits(v->agent, MU_FIELD_MAX) || !text_fits(v->reason, 4 * MU_FIELD_MAX) ||
            v->last_seq > INT64_MAX) {
            return false;
        }
    }
    return d->serial <= INT64_MAX && pages_ok(d) && circular_ok(d) &&
           check_mails(d->outside._buffer, d->outside._length) &&
           trips_ok(d->trips._buffer, d->trips._length) &&
           glances_ok(d->glances._buffer, d->glances._length);
}

bool check_roster(const void *sample)
{
    const muster_Roster *r = sample;
    if (!is_process(r->simulator) || !text_fits(r->broker, MU_NAME_MAX) ||
        r->processes._length > MU_PROCESSES_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < r->processes._length; i++) {
        if (!is_process(r->processes._buffer[i])) {
            return false;
        }
    }
    return true;
}

bool check_broker_status(const void *sample)
{
    const muster_BrokerStatus *s = sample;
    return is_process(s->broker);
}

bool check_part_status(const void *sample)
{
    const muster_PartStatus *s = sample;
    if (!is_process(s->broker) || !is_name(s->part) || s->counters._length > PART_COUNTERS_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < s->counters._length; i++) {
        if (!is_name(s->counters._buffer[i].name)) {
            return false;
        }
    }
    return true;
}

bool check_broker_event(const void *sample)
{
    const muster_BrokerEvent *e = sample;
    return is_process(e->broker) && text_fits(e->kind, MU_FIELD_MAX) && is_name(e->agent) &&
           is_name(e->sender);
}

bool check_beacon(const void *sample)
{
    const muster_Beacon *b = sample;
    return is_name(b->broker) && is_count(b->incarnation) && text_fits(b->host, MU_FIELD_MAX);
}
