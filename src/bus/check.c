/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/check.h"

#include "bus/bus.h"
#include "bus/percept.h"
#include "core/name.h"
#include "muster/limits.h"
#include "wire.h"

#include <math.h>
#include <string.h>

/* Names of rules that fired in one step: MU_FIRINGS_PER_STEP symbols, in bytes. */
enum { RULES_TEXT_MAX = 64 * 1024 };

/* Corners of an outline, and its numbers. */
enum { CORNERS_MAX = 64 };

/* Counters of one part of a broker. */
enum { PART_COUNTERS_MAX = 64 };
/* A line of the white pages, in bytes. */
enum { LINE_TEXT_MAX = 511 };
/* A path, and why an order was refused, in bytes. */
enum { FILE_TEXT_MAX = 1023, REASON_TEXT_MAX = 255 };

/* Most fields of a mail are empty, and need no call. */
static bool text_fits(const char *text, size_t max)
{
    return text && (text[0] == '\0' || strnlen(text, max + 1) <= max);
}

static bool is_name(const char *name)
{
    return text_fits(name, MU_NAME_MAX) && mu_name_valid(name);
}

static bool is_process(const char *name)
{
    return text_fits(name, MU_PROCESS_MAX) && name[0] != '\0';
}

/* What is counted from 1; the upper half is no count, so that one more never starts again at 0. */
static bool is_count(uint64_t number)
{
    return number > 0 && number <= INT64_MAX;
}

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

static bool mails_ok(const muster_Mail *mails, uint32_t count)
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

static bool acts_ok(const muster_Act *acts, uint32_t count)
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
    return acts_ok(u->acts._buffer, u->acts._length) && acks_ok(u->acks._buffer, u->acks._length);
}

static bool ranges_ok(const float *range_m, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!isfinite(range_m[i])) {
            return false;
        }
    }
    return true;
}

static bool percepts_ok(const muster_Percept *percepts, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!is_name(percepts[i].robot) || !percept_ok(&percepts[i])) {
            return false;
        }
    }
    return true;
}

bool check_sense(const void *sample)
{
    const muster_Sense *s = sample;
    return is_process(s->process) && s->robots._length <= MU_LOCAL_AGENTS_MAX &&
           percepts_ok(s->robots._buffer, s->robots._length);
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
           mails_ok(d->letters._buffer, d->letters._length);
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
           mails_ok(d->outside._buffer, d->outside._length) &&
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

static bool numbers_ok(const double numbers[], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(numbers[i])) {
            return false;
        }
    }
    return true;
}

bool check_run_command(const void *sample)
{
    const muster_RunCommand *c = sample;
    const double numbers[] = {c->x_m,       c->y_m,       c->heading_rad, c->force_x_n,
                              c->force_y_n, c->torque_nm, c->time_s,      c->rate};
    return numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) && is_process(c->simulator) &&
           text_fits(c->source, MU_PROCESS_MAX) && (unsigned)c->order <= muster_RUN_HOLD &&
           text_fits(c->name, MU_FIELD_MAX) && text_fits(c->file, FILE_TEXT_MAX) &&
           text_fits(c->when, MU_CONDITION_MAX);
}

bool check_run_answer(const void *sample)
{
    const muster_RunAnswer *a = sample;
    return is_process(a->simulator) && text_fits(a->source, MU_PROCESS_MAX) &&
           (unsigned)a->result <= muster_ORDER_NOT_WRITTEN && text_fits(a->reason, REASON_TEXT_MAX);
}

static bool objects_ok(const muster_ObjectPlace *objects, uint32_t count)
{
    bool fit = count <= MU_OBJECTS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        const muster_ObjectPlace *o = &objects[i];
        fit = text_fits(o->name, MU_NAME_MAX) && isfinite(o->x_m) && isfinite(o->y_m) &&
              isfinite(o->heading_rad);
    }
    return fit;
}

bool check_run_status(const void *sample)
{
    const muster_RunStatus *s = sample;
    if (!is_process(s->simulator) || !text_fits(s->hash, MU_FIELD_MAX + 1) ||
        !text_fits(s->waits_for, MU_CONTENT_MAX) || s->robots._length > MU_ROBOTS_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < s->robots._length; i++) {
        if (!is_name(s->robots._buffer[i].robot)) {
            return false;
        }
    }
    return objects_ok(s->objects._buffer, s->objects._length);
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

/* --- what observers see ----------------------------------------------------------------------- */

static bool outline_ok(const muster_Outline *o)
{
    return isfinite(o->radius_m) && o->corners_m._length <= 2 * CORNERS_MAX &&
           o->corners_m._length % 2 == 0 && ranges_ok(o->corners_m._buffer, o->corners_m._length);
}

static bool mounts_ok(const muster_Mount *mounts, uint32_t count)
{
    bool fit = count <= MU_SONARS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        const muster_Mount *m = &mounts[i];
        const double numbers[] = {m->x_m, m->y_m, m->heading_rad, m->fov_rad, m->range_m};
        fit = numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) && m->beams <= MU_BEAMS_MAX;
    }
    return fit;
}

static bool figures_ok(const muster_Figure *figures, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const muster_Figure *f = &figures[i];
        const double numbers[] = {f->x_m, f->y_m, f->heading_rad};
        if (!text_fits(f->name, MU_NAME_MAX) || !text_fits(f->color, MU_FIELD_MAX) ||
            !numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) || !outline_ok(&f->shape) ||
            !mounts_ok(f->sonars._buffer, f->sonars._length) ||
            !mounts_ok(f->lasers._buffer, f->lasers._length)) {
            return false;
        }
    }
    return true;
}

bool check_scene(const void *sample)
{
    const muster_Scene *s = sample;
    const double numbers[] = {s->min_x_m, s->min_y_m, s->max_x_m, s->max_y_m};
    if (!is_process(s->simulator) || !text_fits(s->world, FILE_TEXT_MAX) ||
        !numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) ||
        s->robots._length > MU_ROBOTS_MAX || s->objects._length > MU_OBJECTS_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < s->walls._length; i++) {
        if (!outline_ok(&s->walls._buffer[i])) {
            return false;
        }
    }
    return figures_ok(s->robots._buffer, s->robots._length) &&
           figures_ok(s->objects._buffer, s->objects._length);
}

static bool views_ok(const muster_RobotView *views, uint32_t count)
{
    bool fit = count <= MU_ROBOTS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        const muster_RobotView *v = &views[i];
        const double numbers[] = {v->x_m,
                                  v->y_m,
                                  v->heading_rad,
                                  v->forward_m_s,
                                  v->turn_rad_s,
                                  v->command_forward_m_s,
                                  v->command_turn_rad_s,
                                  v->distance_m,
                                  v->stalled_s};
        fit = is_name(v->name) && text_fits(v->goal, MU_FIELD_MAX) &&
              numbers_ok(numbers, sizeof numbers / sizeof numbers[0]);
    }
    return fit;
}

static bool orders_ok(const muster_RunCommand *orders, uint32_t count)
{
    bool fit = count <= MU_ORDERS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        fit = check_run_command(&orders[i]);
    }
    return fit;
}

bool check_frame(const void *sample)
{
    const muster_Frame *f = sample;
    return is_process(f->simulator) && f->acts._length <= MU_FRAME_ACTS_MAX &&
           f->percepts._length <= MU_ROBOTS_MAX && f->outside._length <= MU_FRAME_MAILS_MAX &&
           views_ok(f->robots._buffer, f->robots._length) &&
           objects_ok(f->objects._buffer, f->objects._length) &&
           percepts_ok(f->percepts._buffer, f->percepts._length) &&
           acts_ok(f->acts._buffer, f->acts._length) &&
           mails_ok(f->outside._buffer, f->outside._length) &&
           orders_ok(f->orders._buffer, f->orders._length);
}
