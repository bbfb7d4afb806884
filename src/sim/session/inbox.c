/* SPDX-License-Identifier: Apache-2.0 */
/* Takes what has come on every topic. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/text.h"
#include "muster/version.h"

#include <math.h>
#include <string.h>

/* Reads any other number as no order. */
static int32_t order_of(int32_t order)
{
    return order >= -1 && order <= 1 ? order : 0;
}

/* Notes an act for the conditions of orders and events. */
static void act_note(struct session *s, const struct session_agent *agent, const muster_Act *act)
{
    int number = agent->body;
    if (agent->totals < 0) {
        return; /* no condition knows an agent that came while the run went on */
    }
    if (agent->body < 0) {
        number = CONDITION_AGENTS + (agent->totals - (int)s->robot_count);
    }
    order_queue_note_act(s->orders, number, act);
    if (s->options.events) {
        events_note_act(s->options.events, number, act);
    }
}

static void robot_act(struct session *s, struct session_robot *r, const muster_Act *act)
{
    bool is_speed = isfinite(act->forward_m_s) && isfinite(act->turn_rad_s);
    if (act->drives && !is_speed) {
        mu_log(MU_LOG_WARNING, "speed-refused", "robot=%s step=%lld", act->agent,
               (long long)s->step);
    }
    r->drives = act->drives && is_speed;
    if (r->drives) {
        r->forward_m_s = act->forward_m_s;
        r->turn_rad_s = act->turn_rad_s;
    }
    r->paddles = order_of(act->paddles);
    r->lift = order_of(act->lift);
    r->senses = act->senses;
    mu_text_copy(r->goal, sizeof r->goal, act->goal);
}

/* @return whether the agent has said the same in this step before: it does so if its process has
 * died while others were awaited */
static bool act_repeats(struct session *s, struct session_agent *agent, const muster_Act *act,
                        int64_t step)
{
    unsigned char before[RUN_HASH_BYTES];
    memcpy(before, agent->digest, sizeof before);
    run_hash_act(s->hash, act, agent->digest);
    bool again = agent->acted == step + 1;
    agent->acted = step + 1;
    return again && memcmp(before, agent->digest, sizeof before) == 0;
}

static void act_take(struct session *s, const muster_Act *act, int32_t process, int64_t step)
{
    struct session_agent *agent = agents_find(&s->agents, act->agent);
    if (!agent || agent->process != process) {
        return;
    }
    agent->state = act->state;
    if (agent->body >= 0) {
        robot_act(s, &s->robots[agent->body], act);
    }
    if (act_repeats(s, agent, act, step)) {
        return;
    }
    if (agent->totals >= 0) {
        s->totals[agent->totals].told.firings += act->firings;
        s->totals[agent->totals].told.mails_sent += act->mails._length;
    }
    act_note(s, agent, act);
    observe_act(s, (size_t)(agent - s->agents.at), act);
}

/* In free running agents send mail at once: such an act only goes into the Frame. */
static void up_show(struct session *s, const muster_Up *up, int32_t process)
{
    for (uint32_t i = 0; i < up->acts._length; i++) {
        const struct session_agent *agent = agents_find(&s->agents, up->acts._buffer[i].agent);
        if (!agent || agent->process != process || process < 0) {
            continue;
        }
        act_note(s, agent, &up->acts._buffer[i]);
        observe_act(s, (size_t)(agent - s->agents.at), &up->acts._buffer[i]);
    }
}

static void ack_note(struct session *s, const muster_Ack *ack)
{
    const struct session_agent *agent = agents_find(&s->agents, ack->box);
    if (agent && agent->totals >= 0) {
        struct session_totals *t = &s->totals[agent->totals];
        t->told.mails_received = t->returned ? ack->number : ack->handed;
        t->told.mails_duplicated = ack->handed > ack->number ? ack->handed - ack->number : 0;
    }
}

static void up_take(struct session *s, const muster_Up *up)
{
    int32_t process = roster_process(s, up->process);
    if (s->options.free && up->step == muster_STEP_NOW) {
        up_show(s, up, process);
    }
    if (process >= 0) {
        s->processes[process].joined |= MEMBER_HEARD;
    }
    bool is_answer = up->step == s->step || (s->options.free && up->step >= 0);
    if (process < 0 || !is_answer || s->processes[process].answered >= up->step) {
        return;
    }
    struct session_process *p = &s->processes[process];
    if (!member_on(p, MEMBER_ANSWER)) {
        return;
    }
    p->answered = up->step;
    p->answered_wall_ns = mu_clock_ns();
    if (s->answers_missing > 0 && up->step == s->step) {
        s->answers_missing--;
    }
    if (up->trips._length > 0 && !s->options.free) {
        (void)phase_on(s, PHASE_DEPARTURE);
    }
    for (uint32_t i = 0; i < up->acts._length; i++) {
        act_take(s, &up->acts._buffer[i], process, up->step);
    }
    for (uint32_t i = 0; i < up->acks._length; i++) {
        ack_note(s, &up->acks._buffer[i]);
    }
}

/* The broker has moved an agent to a process, or has begun one there.  Answers of its earlier
 * process may still arrive in this step. */
static void trip_take(struct session *s, const muster_Trip *t)
{
    int32_t process = roster_process(s, t->process);
    if (t->word != muster_TRIP_TAKEN || s->options.free || process < 0) {
        return;
    }
    bool died = s->processes[process].state == MEMBER_RELEASED;
    if (agents_seat(&s->agents, t->agent, died ? -1 : process) != MU_OK) {
        mu_log(MU_LOG_WARNING, "guest-left-out", "name=%s step=%lld", t->agent, (long long)s->step);
    }
}

static void delivery_take(struct session *s, const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->trips._length; i++) {
        trip_take(s, &d->trips._buffer[i]);
    }
    if (d->step == muster_STEP_NOW || d->step <= s->mail_step) {
        return;
    }
    s->mail_step = d->step;
    observe_outside(s, d);
    run_hash_outside(s->hash, d->outside._buffer, d->outside._length, s->outside[d->step & 1]);
}

/* While steps run, the roster changes only by processes that die and are started again.  Any other
 * process that does not answer is found by its silence. */
static void registrations_take(struct session *s)
{
    enum bus_life life;
    const muster_Registration *r;
    char who[128];
    while (bus_reader_meets(&s->registrations, who, sizeof who)) {
        mu_log(MU_LOG_WARNING, "other-version",
               "who=\"%s\" ours=%s does=\"it is not heard: use programs of one version\"", who,
               MU_VERSION);
    }
    while ((r = bus_next(&s->registrations, &life))) {
        bool is_ours = life != BUS_DATA || (!r->is_broker && r->wire == muster_WIRE);
        if (!is_ours) {
            continue;
        }
        if (!phase_has_begun(s) || s->options.free) {
            roster_register(s, r, life);
            continue;
        }
        roster_hear(s, r, life);
    }
}

static void run_commands_take(struct session *s)
{
    enum bus_life life;
    const muster_RunCommand *c;
    while ((c = bus_next(&s->commands, &life))) {
        if (life != BUS_DATA || strcmp(c->simulator, s->name) != 0) {
            continue;
        }
        if (c->order > muster_RUN_END) {
            commands_take(s, c);
        } else {
            (void)phase_on(s, c->order == muster_RUN_GO ? PHASE_GO : PHASE_END);
        }
    }
}

void inbox_take(struct session *s)
{
    enum bus_life life;
    const muster_Up *up;
    while ((up = bus_next(&s->ups, &life))) {
        if (life == BUS_DATA) {
            up_take(s, up);
        }
    }
    const muster_Delivery *delivery;
    while ((delivery = bus_next(&s->deliveries, &life))) {
        if (life == BUS_DATA) {
            delivery_take(s, delivery);
        }
    }
    registrations_take(s);
    run_commands_take(s);
}
