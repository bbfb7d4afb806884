/* SPDX-License-Identifier: Apache-2.0 */
#include "story/story.h"

#include "core/text.h"

#include <stdio.h>
#include <string.h>

/* Each comparison notes what differs.  @return whether it does */

static bool note(struct difference *d, const char *who, const char *what)
{
    mu_text_copy(d->who, sizeof d->who, who);
    mu_text_copy(d->what, sizeof d->what, what);
    return true;
}

static bool reals(struct difference *d, const char *who, const char *what, double one, double other)
{
    if (memcmp(&one, &other, sizeof one) == 0) {
        return false;
    }
    snprintf(d->one, sizeof d->one, "%.17g", one);
    snprintf(d->other, sizeof d->other, "%.17g", other);
    return note(d, who, what);
}

static bool numbers(struct difference *d, const char *who, const char *what, long long one,
                    long long other)
{
    if (one == other) {
        return false;
    }
    snprintf(d->one, sizeof d->one, "%lld", one);
    snprintf(d->other, sizeof d->other, "%lld", other);
    return note(d, who, what);
}

/* Of long texts that begin alike, what they differ in. */
static bool texts(struct difference *d, const char *who, const char *what, const char *one,
                  const char *other)
{
    enum { BEFORE = 20 };
    size_t alike = 0;
    if (strcmp(one, other) == 0) {
        return false;
    }
    while (one[alike] == other[alike]) {
        alike++;
    }
    size_t from = alike > BEFORE ? alike - BEFORE : 0;
    snprintf(d->one, sizeof d->one, "%s%s", from > 0 ? "..." : "", one + from);
    snprintf(d->other, sizeof d->other, "%s%s", from > 0 ? "..." : "", other + from);
    return note(d, who, what);
}

/* --- bodies ----------------------------------------------------------------------------------- */

static bool robots_differ(const muster_RobotView *a, const muster_RobotView *b,
                          struct difference *d)
{
    return texts(d, a->name, "name", a->name, b->name) ||
           reals(d, a->name, "x_m", a->x_m, b->x_m) || reals(d, a->name, "y_m", a->y_m, b->y_m) ||
           reals(d, a->name, "heading_rad", a->heading_rad, b->heading_rad) ||
           reals(d, a->name, "forward_m_s", a->forward_m_s, b->forward_m_s) ||
           reals(d, a->name, "turn_rad_s", a->turn_rad_s, b->turn_rad_s) ||
           numbers(d, a->name, "stalled", a->stalled, b->stalled) ||
           numbers(d, a->name, "fault", a->fault, b->fault);
}

static bool objects_differ(const muster_ObjectPlace *a, const muster_ObjectPlace *b,
                           struct difference *d)
{
    return texts(d, a->name, "name", a->name, b->name) ||
           reals(d, a->name, "x_m", a->x_m, b->x_m) || reals(d, a->name, "y_m", a->y_m, b->y_m) ||
           reals(d, a->name, "heading_rad", a->heading_rad, b->heading_rad);
}

static bool bodies_differ(const muster_Frame *a, const muster_Frame *b, struct difference *d)
{
    bool differs = numbers(d, "", "robots", a->robots._length, b->robots._length) ||
                   numbers(d, "", "objects", a->objects._length, b->objects._length);
    for (uint32_t i = 0; !differs && i < a->robots._length; i++) {
        differs = robots_differ(&a->robots._buffer[i], &b->robots._buffer[i], d);
    }
    for (uint32_t i = 0; !differs && i < a->objects._length; i++) {
        differs = objects_differ(&a->objects._buffer[i], &b->objects._buffer[i], d);
    }
    return differs;
}

static bool commands_differ(const muster_Frame *one, const muster_Frame *other,
                            struct difference *d)
{
    bool differs = false;
    for (uint32_t i = 0; !differs && i < one->robots._length; i++) {
        const muster_RobotView *a = &one->robots._buffer[i], *b = &other->robots._buffer[i];
        differs =
            reals(d, a->name, "command_forward_m_s", a->command_forward_m_s,
                  b->command_forward_m_s) ||
            reals(d, a->name, "command_turn_rad_s", a->command_turn_rad_s, b->command_turn_rad_s);
    }
    return differs;
}

/* --- what agents did -------------------------------------------------------------------------- */

static bool mails_differ(const muster_Mail *a, const muster_Mail *b, struct difference *d)
{
    return texts(d, a->src, "mail.src", a->src, b->src) ||
           numbers(d, a->src, "mail.seq", (long long)a->seq, (long long)b->seq) ||
           texts(d, a->src, "mail.dst", a->dst, b->dst) ||
           texts(d, a->src, "mail.performative", a->performative, b->performative) ||
           texts(d, a->src, "mail.content", a->content, b->content);
}

static bool mail_lists_differ(const char *who, const dds_sequence_muster_Mail *a,
                              const dds_sequence_muster_Mail *b, struct difference *d)
{
    uint32_t both = a->_length < b->_length ? a->_length : b->_length;
    bool differs = false;
    for (uint32_t i = 0; !differs && i < both; i++) {
        differs = mails_differ(&a->_buffer[i], &b->_buffer[i], d);
    }
    return differs || numbers(d, who, "mails", a->_length, b->_length);
}

static bool acts_differ(const muster_Act *a, const muster_Act *b, struct difference *d)
{
    /* A mind of a checkpoint begins its trace anew, where the one that did not die goes on. */
    bool diaries = a->diary[0] && b->diary[0] && (a->diary[0] == '0') == (b->diary[0] == '0');
    return numbers(d, a->agent, "act.state", a->state, b->state) ||
           numbers(d, a->agent, "act.drives", a->drives, b->drives) ||
           reals(d, a->agent, "act.forward_m_s", a->forward_m_s, b->forward_m_s) ||
           reals(d, a->agent, "act.turn_rad_s", a->turn_rad_s, b->turn_rad_s) ||
           numbers(d, a->agent, "act.paddles", a->paddles, b->paddles) ||
           numbers(d, a->agent, "act.lift", a->lift, b->lift) ||
           numbers(d, a->agent, "act.firings", a->firings, b->firings) ||
           texts(d, a->agent, "act.rules", a->rules, b->rules) ||
           mail_lists_differ(a->agent, &a->mails, &b->mails, d) ||
           (diaries && texts(d, a->agent, "act.diary", a->diary, b->diary));
}

/* Answers stand in a Frame as they came. */
static const muster_Act *act_find(const muster_Frame *f, const char *agent, uint32_t hint)
{
    if (hint < f->acts._length && strcmp(f->acts._buffer[hint].agent, agent) == 0) {
        return &f->acts._buffer[hint];
    }
    for (uint32_t i = 0; i < f->acts._length; i++) {
        if (strcmp(f->acts._buffer[i].agent, agent) == 0) {
            return &f->acts._buffer[i];
        }
    }
    return NULL;
}

static bool all_acts_differ(const muster_Frame *a, const muster_Frame *b, struct difference *d)
{
    bool differs = numbers(d, "", "acts", a->acts._length, b->acts._length);
    for (uint32_t i = 0; !differs && i < a->acts._length; i++) {
        const muster_Act *one = &a->acts._buffer[i];
        const muster_Act *other = act_find(b, one->agent, i);
        differs = numbers(d, one->agent, "acts", 1, other != NULL) || acts_differ(one, other, d);
    }
    return differs;
}

/* --- what came from outside ------------------------------------------------------------------- */

static bool orders_differ(const muster_RunCommand *a, const muster_RunCommand *b,
                          struct difference *d)
{
    return texts(d, a->source, "order.source", a->source, b->source) ||
           numbers(d, a->source, "order", a->order, b->order) ||
           texts(d, a->source, "order.name", a->name, b->name) ||
           reals(d, a->source, "order.x_m", a->x_m, b->x_m) ||
           reals(d, a->source, "order.y_m", a->y_m, b->y_m) ||
           reals(d, a->source, "order.heading_rad", a->heading_rad, b->heading_rad) ||
           reals(d, a->source, "order.force_x_n", a->force_x_n, b->force_x_n) ||
           reals(d, a->source, "order.force_y_n", a->force_y_n, b->force_y_n) ||
           reals(d, a->source, "order.torque_nm", a->torque_nm, b->torque_nm) ||
           reals(d, a->source, "order.time_s", a->time_s, b->time_s) ||
           numbers(d, a->source, "order.senses", a->senses, b->senses) ||
           numbers(d, a->source, "order.on", a->on, b->on);
}

static bool outside_differs(const muster_Frame *a, const muster_Frame *b, struct difference *d)
{
    bool differs = mail_lists_differ("", &a->outside, &b->outside, d) ||
                   numbers(d, "", "orders", a->orders._length, b->orders._length);
    for (uint32_t i = 0; !differs && i < a->orders._length; i++) {
        differs = orders_differ(&a->orders._buffer[i], &b->orders._buffer[i], d);
    }
    return differs;
}

/* What is seen last of all: the hash knows more than a Frame shows. */
static bool digests_differ(const muster_Frame *a, const muster_Frame *b, struct difference *d)
{
    if (a->digest == b->digest || a->digest == 0 || b->digest == 0) {
        return false;
    }
    snprintf(d->one, sizeof d->one, "%016llx", (unsigned long long)a->digest);
    snprintf(d->other, sizeof d->other, "%016llx", (unsigned long long)b->digest);
    return note(d, "", "digest");
}

bool differ_frames(const muster_Frame *one, const muster_Frame *other, struct difference *d)
{
    *d = (struct difference){.step = one->step};
    return numbers(d, "", "step", one->step, other->step) || bodies_differ(one, other, d) ||
           commands_differ(one, other, d) || outside_differs(one, other, d) ||
           all_acts_differ(one, other, d) || digests_differ(one, other, d);
}

/* The last Frame of a run that did not come to its end: perhaps no agent acted in that step. */
static bool left_differs(const muster_Frame *one, const muster_Frame *other, struct difference *d)
{
    *d = (struct difference){.step = one->step};
    return numbers(d, "", "step", one->step, other->step) || bodies_differ(one, other, d);
}

/* An agent that died may have answered the last step in one life, and not in the other. */
static bool both_broke_off(const struct recording *one, const struct recording *other)
{
    return recording_end(one) == RECORDING_FAULT && recording_end(other) == RECORDING_FAULT;
}

bool differ_find(struct recording *one, struct recording *other, struct difference *d)
{
    enum recording_end end = recording_end(one);
    int64_t last = one->steps_count > 0 ? one->steps[one->steps_count - 1].step : -1;
    bool differs = false;
    recording_rewind(one);
    recording_rewind(other);
    const muster_Frame *a = recording_next(one), *b = recording_next(other);
    while (a && b && !differs) {
        bool left = a->step == last && (end == RECORDING_STOPPED || end == RECORDING_CUT);
        differs = left ? left_differs(a, b, d) : differ_frames(a, b, d);
        a = recording_next(one);
        b = recording_next(other);
    }
    bool missing = a && !(a->step == last && both_broke_off(one, other));
    if (!differs && (missing || (b && end == RECORDING_DONE))) {
        *d = (struct difference){.step = a ? a->step : b->step};
        snprintf(d->one, sizeof d->one, "%s", a ? "there" : "missing");
        snprintf(d->other, sizeof d->other, "%s", a ? "missing" : "there");
        differs = note(d, "", "the step");
    }
    return differs;
}
