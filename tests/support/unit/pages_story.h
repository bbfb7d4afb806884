/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pages_story.h
 * Groups and services in a broker's story: what agents say to the broker, what it answers, and what
 * the process p-red is shown.
 *
 * Of all that is handed out, `heard` has "NAME: SENDER CONTENT" for each mail, and for those of the
 * broker the performative instead of the sender; `shown` has "+GROUP/AGENT", "-GROUP/AGENT",
 * "+SERVICE@AGENT[ATTRIBUTES]" and "-SERVICE@AGENT" for p-red.
 */
#ifndef MUSTER_TESTS_PAGES_STORY_H
#define MUSTER_TESTS_PAGES_STORY_H

#include "broker_story.h"

static char heard[1 << 16], shown[1 << 16];
static uint64_t pages_seq; /* of all senders together */

static inline void show(const muster_Delivery *d)
{
    struct mu_text t;
    mu_text_init(&t, shown, sizeof shown);
    for (uint32_t i = 0; i < d->memberships._length; i++) {
        const muster_Membership *m = &d->memberships._buffer[i];
        mu_text_format(&t, "%s%c%s%s%s", t.len ? " " : "", m->joined ? '+' : '-', m->group,
                       m->agent[0] ? "/" : "", m->agent);
    }
    for (uint32_t i = 0; i < d->offers._length; i++) {
        const muster_Offer *o = &d->offers._buffer[i];
        mu_text_format(&t, "%s%c%s@%s", t.len ? " " : "", o->offered ? '+' : '-', o->service,
                       o->agent);
        if (o->offered) {
            mu_text_format(&t, "[%s]", o->attributes);
        }
    }
}

/* Takes everything that is ready, and acknowledges it unless a lock step is on. */
static inline const char *hear(bool acknowledge)
{
    const char *process;
    muster_Delivery d;
    struct mu_text t;
    struct {
        const char *box; /* the broker's own, which stays */
        uint64_t number;
    } taken[64];
    unsigned count = 0;
    mu_text_init(&t, heard, sizeof heard);
    shown[0] = '\0';
    while (broker_next(story.b, &process, &d)) {
        for (uint32_t i = 0; i < d.parcels._length; i++) {
            const muster_Parcel *p = &d.parcels._buffer[i];
            bool own = strcmp(p->letter.src, "broker") == 0;
            mu_text_format(&t, "%s%s: %s %s", t.len ? "; " : "", p->box,
                           own ? p->letter.performative : p->letter.src, p->letter.content);
            taken[count % 64].box = p->box;
            taken[count++ % 64].number = p->number;
        }
        if (strcmp(process, "p-red") == 0 && (d.memberships._length || d.offers._length)) {
            show(&d);
        }
        broker_delivered(story.b, story.now_ns);
    }
    for (unsigned i = 0; i < count && i < 64 && acknowledge; i++) {
        story_ack(taken[i].box, taken[i].number);
    }
    return heard;
}

static inline muster_Mail to_broker(const char *src, const char *performative, const char *content)
{
    muster_Mail m = letter(src, ++pages_seq, "broker", content);
    m.layer = 2;
    m.performative = words(performative);
    m.reply_with = words("r");
    return m;
}

/* Says something to the broker, out of lock step.  @return what is heard then */
static inline const char *say(const char *src, const char *performative, const char *content)
{
    story_mail(to_broker(src, performative, content));
    return hear(true);
}

static inline void pages_roster(bool lockstep, int64_t step, const char *first, const char *second)
{
    char *processes[2] = {words(first), words(second)};
    muster_Roster roster = {
        .simulator = words("sim"), .lockstep = lockstep, .step = step, .step_ns = 100 * MS};
    roster.processes._buffer = processes;
    roster.processes._length = second ? 2 : 1;
    broker_roster(story.b, &roster, story.now_ns);
}

/* Answers a step with one mail, or with none. */
static inline void answer_step(const char *name, int64_t step, muster_Mail *mail)
{
    story_up(name, step, muster_STATE_RUNNING, mail, mail ? 1 : 0, 0);
}

#define HEARD(wanted, call)                                             \
    do {                                                                \
        const char *heard_ = (call);                                    \
        if (strcmp(heard_, (wanted)) != 0) {                            \
            printf("\n  wanted: %s\n  got:    %s\n", (wanted), heard_); \
        }                                                               \
        CU_ASSERT_STRING_EQUAL(heard_, (wanted));                       \
    } while (0)

#define SHOWN(wanted) HEARD(wanted, shown)

#endif
