/* SPDX-License-Identifier: Apache-2.0 */
#include "history.h"

#include <string.h>

static struct history_process *any_process(void)
{
    return &history.processes[history_roll(PROCESSES)];
}

/* @return an agent of a process that lives, or NULL */
static struct actor *any_agent(struct history_process **of)
{
    struct history_process *p = any_process();
    struct actor *a = &p->seats[history_roll(SEATS)];
    *of = p;
    return p->alive && a->name != NOBODY && !a->leaving ? a : NULL;
}

/* --- coming and going ------------------------------------------------------------------------- */

static void act_join(void)
{
    struct history_process *p = any_process();
    int seat = (int)history_roll(SEATS), name = (int)history_roll(NAMES);
    if (!p->alive) {
        process_begin(p);
        p->reaches = true;
    }
    if (p->seats[seat].name == NOBODY && !process_agent(p, name)) {
        agent_join(p, seat, name);
    }
}

/* It says so, and its seat stays with it until that has gone out. */
static void act_leave(void)
{
    struct history_process *p;
    struct actor *a = any_agent(&p);
    if (a && history_chance(3) && a->waiting == 0) {
        history_note("%s leaves", history_name(a->name));
        a->leaving = true;
        p->registration_due = true;
    }
}

static void act_crash(void)
{
    struct history_process *p = any_process();
    if (!p->alive || !history_chance(4)) {
        return;
    }
    history_note("%s crashes", p->name);
    p->alive = p->reaches = false;
    p->ups_count = p->deliveries_count = 0;
    net_lose(p, history_chance(3) ? false : true);
}

/* The network loses it for a while; it lives, and knows nothing of that. */
static void act_cut(void)
{
    struct history_process *p = any_process();
    if (p->alive && p->reaches && history_chance(6)) {
        history_note("%s is cut off", p->name);
        p->reaches = false;
        p->ups_count = 0;
        p->deliveries_count = history_chance(2) ? p->deliveries_count : 0;
        for (int seat = 0; seat < SEATS; seat++) {
            history.cut[p->seats[seat].life] = true;
        }
        net_lose(p, true);
    }
}

static void act_mend(void)
{
    struct history_process *p = any_process();
    if (p->alive && !p->reaches) {
        history_note("%s is reached again", p->name);
        p->reaches = true;
        p->registration_due = true;
    }
}

static void act_suspend(void)
{
    struct history_process *p;
    struct actor *a = any_agent(&p);
    if (a) {
        bool suspended = a->state == muster_STATE_SUSPENDED;
        a->state = suspended ? muster_STATE_RUNNING : muster_STATE_SUSPENDED;
        p->registration_due = true;
        history_note("%s %s", history_name(a->name), suspended ? "resumes" : "is suspended");
    }
}

/* --- mail ------------------------------------------------------------------------------------- */

static void mail_ask(struct entry *e)
{
    e->to = TO_BROKER;
    e->layer = 2;
    e->asks = (enum asks)history_roll(ASKS);
    e->key = (int)history_roll(e->asks <= ASK_LEAVE ? GROUPS : SERVICES);
    if (e->asks == ASK_ADVERTISE && history_chance(2)) {
        e->ttl_ns = (1 + history_roll(4000)) * MS + MS / 2;
    }
}

static void mail_address(struct entry *e)
{
    static const enum to_whom kinds[] = {TO_NAMES, TO_NAMES,  TO_NAMES, TO_NAMES, TO_NAMES,
                                         TO_ALL,   TO_ROBOTS, TO_GROUP, TO_GROUP};
    e->to = kinds[history_roll(9)];
    e->key = (int)history_roll(GROUPS);
    uint32_t many = history_chance(4) ? 1 + history_roll(5) : 1;
    for (uint32_t i = 0; i < many; i++) {
        e->addressed |= 1u << history_roll(NAMES / (history_chance(2) ? 4 : 1));
    }
    e->to_unknown = e->to == TO_NAMES && history_chance(20);
}

static void mail_fill(struct entry *e)
{
    if (history_chance(6)) {
        mail_ask(e);
        return;
    }
    mail_address(e);
    e->level = (muster_Level)history_roll(3);
    e->priority = history_chance(3) ? (int32_t)history_roll(3) - 1 : 0;
    e->ttl_ns = history_chance(8) ? (1 + history_roll(2000)) * MS : 0;
    e->due_ns = history_chance(12) ? (int64_t)(history.now_ns + history_roll(1500) * MS) : -1;
    if (history_chance(20)) {
        e->layer = 0;
    }
}

static void act_send(void)
{
    struct history_process *p;
    struct actor *a = any_agent(&p);
    uint32_t many = history_chance(6) ? 1 + history_roll(12) : 1;
    for (uint32_t i = 0; a && i < many && a->waiting < OUTBOX && history.mails < MAILS; i++) {
        uint32_t mail = ledger_open(a->name, a->life);
        mail_fill(&history.ledger[mail]);
        (void)agent_send(a, mail);
    }
}

/* --- the broker, its disk, and nonsense ------------------------------------------------------- */

static void act_kill(void)
{
    if (history.life.b && history_chance(12)) {
        life_kill();
    }
}

static void act_begin(void)
{
    if (!history.life.b) {
        life_begin();
    }
}

static void act_disk(void)
{
    if (history.life.disk_fails || history_chance(8)) {
        history.life.disk_fails = !history.life.disk_fails;
        history_note("the disk %s", history.life.disk_fails ? "fails" : "works");
    }
}

/* Samples that no runtime writes: the broker counts them and goes on. */
static void act_nonsense(void)
{
    static char far_too_long[4 * MU_DST_MAX];
    memset(far_too_long, 'x', sizeof far_too_long - 1);
    if (!history.life.b) {
        return;
    }
    struct history_process *p = any_process();
    const char *const bad[] = {"", "n", far_too_long, "\xff\xfe", p->name, "na,,nb"};
    muster_Ack ack = {.box = words(bad[history_roll(6)]), .number = UINT64_MAX - 1};
    muster_Up up = {.process = words(bad[history_roll(6)]),
                    .broker_incarnation = history.life.incarnation,
                    .step = muster_STEP_NOW};
    up.acks = (dds_sequence_muster_Ack){._length = 1, ._maximum = 1, ._buffer = &ack};
    muster_Entry entry = {.reason = words(""),
                          .name = words(bad[2]),
                          .kind = (muster_Kind)99,
                          .state = (muster_State)history_roll(9),
                          .home = words("")};
    muster_Registration r = {.wire = muster_WIRE,
                             .process = words(bad[history_roll(4)]),
                             .broker = words(bad[history_roll(4)]),
                             .incarnation = 1,
                             .host = words("")};
    r.agents._buffer = &entry;
    r.agents._length = r.agents._maximum = 1;
    muster_BrokerStatus was = life_status();
    broker_up(history.life.b, &up, life_now_ns());
    broker_registration(history.life.b, &r, life_now_ns());
    broker_gone(history.life.b, bad[history_roll(4)], UINT32_MAX, history_chance(2), life_now_ns());
    HOLD(life_status().malformed > was.malformed && life_status().sent == was.sent);
}

void acts_one(void)
{
    static void (*const acts[])(void) = {
        act_join, act_join, act_leave, act_crash, act_cut,  act_mend, act_mend,    act_suspend,
        act_send, act_send, act_send,  act_send,  act_send, act_send, act_send,    act_send,
        act_send, act_kill, act_begin, act_begin, act_disk, act_send, act_nonsense};
    acts[history_roll(sizeof acts / sizeof acts[0])]();
}
