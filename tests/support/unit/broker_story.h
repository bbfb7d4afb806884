/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file broker_story.h
 * Lets a broker test read like a story: agents join, send and acknowledge, and what the broker
 * hands out is one line of text.
 *
 * The agent `red` lives in the process `p-red` unless the story says otherwise.  Of each Delivery
 * the text has, in this order and separated by "; ":
 *
 *     PROCESS@STEP                 in lock step only
 *     NAME #NUMBER SRC/SEQ CONTENT a delivery item
 *     NAME FIRST-LAST OUTCOME      receipts
 *     NAME welcome SEQ             an accepted registration, and the last mail of that name
 *     NAME: REASON                 a refused one
 *     outside SRC/SEQ              to the simulator
 *     roll call
 *     PROCESS: NAME WORD EPOCH [REASON] [TEXT]   to a process, of an agent on its way
 *     PROCESS: ASKER/NUMBER NAME WORD TEXT       to a process, of a probe at an agent
 *
 * And of a multicast, with the boxes by name:
 *
 *     all: NAME #NUMBER, NAME #NUMBER | SRC/SEQ CONTENT, SRC/SEQ CONTENT
 */
#ifndef MUSTER_TESTS_BROKER_STORY_H
#define MUSTER_TESTS_BROKER_STORY_H

#include "broker/control/parts.h"
#include "brokers.h"
#include "core/table.h"
#include "core/text.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MS 1000000ull

enum { STORY_SEATS = 1024 };

/* What a process knows of the seat that the broker has given it. */
struct story_seat {
    char process[MU_PROCESS_MAX + 1];
    uint64_t serial; /* of what came last */
};

struct story {
    struct broker *b;
    uint64_t now_ns;
    uint32_t members; /* lines of the white pages that the last story_collect saw */
    uint32_t again;   /* mails that it saw and that may have come before */
    uint32_t gaps;    /* times that something to a process was not the next by its serial */
    const struct broker *seats_of;
    struct story_seat seats[STORY_SEATS];
    struct mu_text text;
    char buffer[1 << 16];
};

static struct story story;

static inline void story_begin_with(uint64_t delivery_interval_ns, bool audit)
{
    struct broker_options options = {.name = "alpha",
                                     .incarnation = 5,
                                     .pid = 9,
                                     .wall_ns = 1000,
                                     .delivery_interval_ns = delivery_interval_ns,
                                     .audit = audit};
    story.b = broker_kept(&options);
    story.now_ns = 0;
    story.gaps = 0;
    story.seats_of = NULL;
    mu_text_init(&story.text, story.buffer, sizeof story.buffer);
}

static inline void story_begin(void)
{
    story_begin_with(0, false);
}

static char story_names[2 * MU_AGENTS_MAX][MU_PROCESS_MAX + 1]; /* by slot */

/* Each name has the same slot in whatever process it is. */
static inline uint32_t story_slot(const char *name)
{
    static struct mu_table slots;
    if (!slots.slots) {
        mu_table_init(&slots, 2 * MU_AGENTS_MAX);
    }
    uint32_t slot = name ? mu_table_find(&slots, name) : 0;
    if (slot == MU_NONE) {
        slot = slots.count;
        (void)mu_text_copy(story_names[slot], sizeof story_names[slot], name);
        CU_ASSERT_EQUAL_FATAL(mu_table_put(&slots, story_names[slot], slot), MU_OK);
    }
    return slot % MU_LOCAL_AGENTS_MAX;
}

/* A part that says something of one agent alone. */
static inline muster_Registration registration(const char *name, const char *process)
{
    static muster_Entry parts[16][MU_PART_AGENTS];
    static unsigned turn;
    muster_Entry *entries = parts[turn++ % 16];
    uint32_t slot = story_slot(name);
    for (uint32_t i = 0; i < MU_PART_AGENTS; i++) {
        entries[i] = (muster_Entry){.reason = words(""),
                                    .name = words(""),
                                    .state = muster_STATE_ABSENT,
                                    .home = words("")};
    }
    entries[slot % MU_PART_AGENTS] = (muster_Entry){.reason = words(""),
                                                    .name = words(name),
                                                    .kind = muster_KIND_ROBOT,
                                                    .state = muster_STATE_RUNNING,
                                                    .home = words("")};
    muster_Registration r = {.wire = muster_WIRE,
                             .process = words(process),
                             .part = slot / MU_PART_AGENTS,
                             .broker = words(""),
                             .incarnation = 1,
                             .host = words("here"),
                             .pid = 1};
    r.agents._buffer = entries;
    r.agents._length = r.agents._maximum = slot % MU_PART_AGENTS + 1;
    return r;
}

/* The one entry of a registration. */
static inline muster_Entry *entry_of(const muster_Registration *r)
{
    return &r->agents._buffer[r->agents._length - 1];
}

static inline void story_register(const char *name, const char *process)
{
    muster_Registration r = registration(name, process);
    if (strcmp(name, "operator") == 0 || strcmp(name, "observer") == 0) {
        entry_of(&r)->kind = muster_KIND_SPECIAL;
    }
    broker_registration(story.b, &r, story.now_ns);
}

/* No broker has given it the name before.  epoch: how often it has set out; 0: never */
static inline void story_register_newcomer(const char *name, const char *process, uint64_t epoch)
{
    muster_Registration r = registration(name, process);
    entry_of(&r)->newcomer = true;
    entry_of(&r)->epoch = epoch;
    broker_registration(story.b, &r, story.now_ns);
}

/** @return whether the broker serves a process */
static inline bool story_serves(const char *process)
{
    return processes_find(&story.b->processes, process) != MU_NONE;
}

/** @return whether it serves one whose reader is not there */
static inline bool story_awaits(const char *process)
{
    uint32_t place = processes_find(&story.b->processes, process);
    return place != MU_NONE && !processes_is_matched(&story.b->processes.at[place]);
}

/** @return how many such processes there are */
static inline uint32_t story_awaited(void)
{
    uint32_t awaited = 0;
    for (uint32_t i = 0; i < story.b->processes.top; i++) {
        const struct process *at = &story.b->processes.at[i];
        awaited += at->session != SESSION_FREE && !processes_is_matched(at);
    }
    return awaited;
}

static inline void story_match(const char *process)
{
    broker_matched(story.b, process, true, story.now_ns);
}

/* An onlooker registers: it wants no broadcasts. */
static inline void story_look_on(const char *name, const char *process)
{
    muster_Registration r = registration(name, process);
    entry_of(&r)->no_broadcasts = true;
    broker_registration(story.b, &r, story.now_ns);
    story_match(process);
}

/* An agent leaves its process. */
static inline void story_leave(const char *name, const char *process)
{
    muster_Registration r = registration(name, process);
    entry_of(&r)->state = muster_STATE_ABSENT;
    broker_registration(story.b, &r, story.now_ns);
}

static inline void story_state(const char *name, muster_State state)
{
    char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "p-%s", name);
    muster_Registration r = registration(name, process);
    entry_of(&r)->state = state;
    broker_registration(story.b, &r, story.now_ns);
}

/* A process crashes. */
static inline void story_gone(const char *process)
{
    broker_gone(story.b, process, 0, true, story.now_ns);
}

/* --- what the broker hands out ---------------------------------------------------------------- */

static inline void story_line(const char *line)
{
    mu_text_add(&story.text, story.text.len ? "; " : "");
    mu_text_add(&story.text, line);
}

/* Something has come to a process. */
static inline void story_serial(struct story_seat *seat, uint64_t serial)
{
    story.gaps += serial != seat->serial + 1;
    seat->serial = serial;
}

/* A Delivery tells its process the seat; a probe counts for nothing. */
static inline void story_seat(const muster_Delivery *d)
{
    if (story.seats_of != story.b) {
        story.seats_of = story.b;
        memset(story.seats, 0, sizeof story.seats);
    }
    CU_ASSERT_TRUE(d->seat > 0);
    if (d->seat >= STORY_SEATS) { /* nobody asks for it */
        return;
    }
    struct story_seat *seat = &story.seats[d->seat];
    if (seat->process[0] == '\0') {
        (void)mu_text_copy(seat->process, sizeof seat->process, d->process);
    }
    CU_ASSERT_STRING_EQUAL(seat->process, d->process);
    if (d->glances._length == 0) {
        story_serial(seat, d->serial);
    } else {
        CU_ASSERT_EQUAL(d->serial, 0);
    }
}

/* The boxes of a multicast are in order of seats, and those of one seat have one serial. */
static inline void story_boxes(const muster_Delivery *d, struct mu_text *line)
{
    uint32_t count = d->seats._length;
    CU_ASSERT_TRUE_FATAL(d->serials._length == count && d->slots._length == count &&
                         d->numbers._length == count && d->letters._length > 0);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t seat = d->seats._buffer[i], before = i ? d->seats._buffer[i - 1] : 0;
        CU_ASSERT_TRUE_FATAL(seat >= before && seat < STORY_SEATS);
        CU_ASSERT_TRUE(story.seats[seat].process[0] != '\0'); /* it knows its seat */
        if (seat > before) {
            story_serial(&story.seats[seat], d->serials._buffer[i]);
        } else {
            CU_ASSERT_EQUAL(d->serials._buffer[i], d->serials._buffer[i - 1]);
        }
        mu_text_format(line, "%s%s #%llu", i ? ", " : "", story_names[d->slots._buffer[i]],
                       (unsigned long long)d->numbers._buffer[i]);
    }
}

static inline void story_circular(const muster_Delivery *d)
{
    static char buffer[1 << 16];
    struct mu_text line;
    mu_text_init(&line, buffer, sizeof buffer);
    mu_text_add(&line, "all: ");
    story_boxes(d, &line);
    for (uint32_t i = 0; i < d->letters._length; i++) {
        const muster_Mail *m = &d->letters._buffer[i];
        mu_text_format(&line, "%s%s/%llu %s", i ? ", " : " | ", m->src, (unsigned long long)m->seq,
                       m->content);
    }
    CU_ASSERT_TRUE(d->parcels._length + d->receipts._length + d->verdicts._length == 0);
    CU_ASSERT_TRUE(d->members._length + d->memberships._length + d->offers._length == 0);
    CU_ASSERT_TRUE(d->seat == 0 && d->serial == 0 && d->step == muster_STEP_NOW && !d->roll_call);
    story_line(line.at);
}

static inline void story_note(const muster_Delivery *d)
{
    char line[MU_CONTENT_MAX + 128];
    CU_ASSERT_STRING_EQUAL(d->broker, "alpha");
    if (d->seats._length > 0) {
        story_circular(d);
        return;
    }
    story_seat(d);
    if (d->step != muster_STEP_NOW) {
        snprintf(line, sizeof line, "%s@%lld", d->process, (long long)d->step);
        story_line(line);
    }
    for (uint32_t i = 0; i < d->parcels._length; i++) {
        const muster_Parcel *p = &d->parcels._buffer[i];
        snprintf(line, sizeof line, "%s #%llu %s/%llu %s", p->box, (unsigned long long)p->number,
                 p->letter.src, (unsigned long long)p->letter.seq, p->letter.content);
        story_line(line);
        story.again += p->letter.again;
    }
    for (uint32_t i = 0; i < d->receipts._length; i++) {
        const muster_Receipt *r = &d->receipts._buffer[i];
        snprintf(line, sizeof line, "%s %llu-%llu %s", r->agent, (unsigned long long)r->first_seq,
                 (unsigned long long)r->last_seq, outcome_word(r->result));
        story_line(line);
    }
    for (uint32_t i = 0; i < d->verdicts._length; i++) {
        const muster_Verdict *v = &d->verdicts._buffer[i];
        if (v->accepted) {
            snprintf(line, sizeof line, "%s welcome %llu", v->agent,
                     (unsigned long long)v->last_seq);
        } else {
            snprintf(line, sizeof line, "%s: %s", v->agent, v->reason);
        }
        story_line(line);
    }
    for (uint32_t i = 0; i < d->outside._length; i++) {
        snprintf(line, sizeof line, "outside %s/%llu", d->outside._buffer[i].src,
                 (unsigned long long)d->outside._buffer[i].seq);
        story_line(line);
    }
    if (d->roll_call) {
        story_line("roll call");
    }
    for (uint32_t i = 0; i < d->trips._length; i++) {
        const muster_Trip *t = &d->trips._buffer[i];
        snprintf(line, sizeof line, "%s: %s %s %llu%s%s%s%s", d->process, t->agent,
                 trip_word(t->word), (unsigned long long)t->epoch, t->reason[0] ? " " : "",
                 t->reason, t->text[0] ? " " : "", t->text);
        story_line(line);
    }
    for (uint32_t i = 0; i < d->glances._length; i++) {
        const muster_Glance *g = &d->glances._buffer[i];
        snprintf(line, sizeof line, "%s: %s/%llu %s %s %s", d->process, g->asker,
                 (unsigned long long)g->number, g->agent, glance_word(g->word), g->text);
        story_line(line);
    }
    story.members += d->members._length;
}

/* Takes everything that is ready.  @return it as text */
static inline const char *story_collect(void)
{
    const char *process;
    muster_Delivery d;
    mu_text_clear(&story.text);
    story.members = story.again = 0;
    while (broker_next(story.b, &process, &d)) {
        CU_ASSERT_STRING_EQUAL(process, d.process);
        story_note(&d);
        broker_delivered(story.b, story.now_ns);
    }
    return story.text.at;
}

/* What is ready is exactly this. */
#define EXPECT(wanted) READS(story_collect(), wanted)

static inline void story_join(const char *name)
{
    char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "p-%s", name);
    story_register(name, process);
    story_match(process);
    (void)story_collect();
}

static inline void story_tick(uint64_t later_ns)
{
    story.now_ns += later_ns;
    broker_tick(story.b, story.now_ns);
}

static inline muster_BrokerStatus story_status(void)
{
    muster_BrokerStatus status;
    broker_status(story.b, &status);
    return status;
}

/* @return the white pages' line of a name, as "NAME STATE PROCESS" */
static inline const char *story_member(const char *name)
{
    static char line[160];
    muster_Member m;
    if (!broker_knows(story.b, name, &m)) {
        return "nobody";
    }
    snprintf(line, sizeof line, "%s %s %s", m.name, state_word(m.state), m.process);
    return line;
}

/* --- what agents say -------------------------------------------------------------------------- */

/* It comes from who knows which life of the broker this is. */
static inline void story_hear(muster_Up *up)
{
    up->broker_incarnation = story.b->incarnation;
    broker_up(story.b, up, story.now_ns);
}

/* The Up of a process with one agent in it. */
/* An agent with nothing to say answers a step. */
static inline void story_up_from(const char *process, const char *name, int64_t step)
{
    struct one_up u;
    one_up(&u, name, process, NULL, 0, 0);
    u.act.state = muster_STATE_RUNNING;
    u.up.step = step;
    broker_up(story.b, &u.up, story.now_ns);
}

static inline void story_up(const char *name, int64_t step, muster_State state, muster_Mail *mails,
                            uint32_t count, uint64_t ack)
{
    char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "p-%s", name);
    struct one_up u;
    one_up(&u, name, process, mails, count, ack);
    u.act.state = state;
    u.up.step = step;
    story_hear(&u.up);
}

/* A line for somebody to carry out. */
static inline muster_Mail directive(const char *src, uint64_t seq, const char *dst,
                                    const char *line)
{
    muster_Mail m = letter(src, seq, dst, line);
    m.layer = 0;
    m.performative = words("do");
    return m;
}

static inline void story_mail(muster_Mail m)
{
    story_up(m.src, muster_STEP_NOW, muster_STATE_RUNNING, &m, 1, 0);
}

static inline void story_send(const char *src, uint64_t seq, const char *dst, const char *content)
{
    story_mail(letter(src, seq, dst, content));
}

static inline void story_ack(const char *name, uint64_t number)
{
    story_up(name, muster_STEP_NOW, muster_STATE_RUNNING, NULL, 0, number);
}

#endif
