/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file base.h
 * Time, versions, limits and the rules of the wire; the pool of mails and the boxes in which they
 * wait have headers of their own.
 */
#ifndef MUSTER_BROKER_BASE_H
#define MUSTER_BROKER_BASE_H

#include "broker/base/mailbox.h"

#include <string.h>

/** Takes the i-th element, of so many bytes, out of an array in order. */
static inline void array_remove(void *array, size_t bytes, uint32_t *count, uint32_t i)
{
    char *at = (char *)array + i * bytes;
    memmove(at, at + bytes, (--*count - i) * bytes);
}

/* --- clock.c --------------------------------------------------------------------------------- */

/*
 * The two times that mail knows.
 *
 * The run's time counts from the start of a run; mail is due by it.  The mail clock never goes
 * back, whatever runs start and end; mail expires by it.  Both move with the broker's clock, or
 * with the steps of a run.
 */

/* CLOCK_COLLECTS: steps move it, and what is done now takes effect when the step ends;
 * CLOCK_COMMITS: steps move it, and what is done now happens in every run. */
enum clock_mode { CLOCK_WALL, CLOCK_COLLECTS, CLOCK_COMMITS };

struct clock {
    uint64_t now_ns;  /* the broker's clock, as last told */
    uint64_t wall_ns; /* nanoseconds since 1970 when that shows 0 */
    enum clock_mode mode;
    bool runs;             /* a run has started */
    uint64_t step_ns;      /* of a run that goes by steps */
    uint64_t run_ns;       /* the run's time at base_ns; if it goes by steps: now */
    uint64_t base_ns;      /* of the broker's clock */
    uint64_t mail_lead_ns; /* the mail clock is so far ahead of the other one, modulo 2^64 */
};

/** @return so long after a time, or never, which is UINT64_MAX */
static inline uint64_t clock_after_ns(uint64_t time_ns, uint64_t span_ns)
{
    return time_ns > UINT64_MAX - span_ns ? UINT64_MAX : time_ns + span_ns;
}

/** Takes note of the broker's clock; an earlier time than the last one counts as the last one. */
static inline void clock_set_now(struct clock *c, uint64_t now_ns)
{
    if (now_ns > c->now_ns) {
        c->now_ns = now_ns;
    }
}

/** A run is at this time now, and goes on by steps of step_ns, or, if that is 0, with the broker's
 * clock. */
void clock_start(struct clock *c, uint64_t step_ns, uint64_t run_ns);

/** @return whether steps move the time */
static inline bool clock_by_steps(const struct clock *c)
{
    return c->mode != CLOCK_WALL;
}

/** @return whether what is done now takes effect only when the step ends */
static inline bool clock_collects(const struct clock *c)
{
    return c->mode == CLOCK_COLLECTS;
}

/** @return the run's time; 0 when none has started */
static inline uint64_t clock_run_ns(const struct clock *c)
{
    if (!c->runs || clock_by_steps(c)) {
        return c->run_ns;
    }
    return c->run_ns + (c->now_ns - c->base_ns);
}

/** @return the mail clock's time */
static inline uint64_t clock_mail_ns(const struct clock *c)
{
    return (clock_by_steps(c) ? c->run_ns : c->now_ns) + c->mail_lead_ns;
}

/** While the broker's clock moves the time: what it shows when another clock, the run's or that of
 * mail, which shows this now, will show that; what is past is due now. */
uint64_t clock_then_ns(const struct clock *c, uint64_t shows_ns, uint64_t then_ns);

/** @return nanoseconds since 1970 */
static inline uint64_t clock_wall_ns(const struct clock *c)
{
    return c->wall_ns + c->now_ns;
}

/** @return the stamp of what is done now: of the run, if it goes by steps; else since 1970 */
uint64_t clock_stamp_ns(const struct clock *c);

/* --- changelog.c ----------------------------------------------------------------------------- */

/*
 * The lines of a table in order of their last change: a reader that remembers the version that it
 * has had finds what is new to it without looking at the rest.
 */

struct change {
    uint64_t version;    /* 0: it is no more, or never was */
    struct mu_link link; /* the next one has the higher version */
    struct mu_link gone; /* of those that are no more */
};

struct changelog {
    struct change *lines; /* one for each line of the table */
    struct mu_list list;  /* from the oldest to the youngest */
    struct mu_list gone;  /* lines that are no more, until changelog_gone has told of them */
    uint64_t version;     /* of the last change; the first is 1 */
};

/** Takes memory at start-up. */
void changelog_init(struct changelog *c, uint32_t capacity);

/** A line has changed, or is new: it is now the youngest. */
void changelog_touch(struct changelog *c, uint32_t line);

/** @return the version at which the line last changed; 0: never, or it is no more */
static inline uint64_t changelog_version(const struct changelog *c, uint32_t line)
{
    return c->lines[line].version;
}

/** A line is no more: it is in the list of those that are gone, until changelog_gone takes it. */
void changelog_remove(struct changelog *c, uint32_t line);

/** @return a line that is no more, or was not for a while, each once; or MU_NONE */
uint32_t changelog_gone(struct changelog *c);

/** @return the oldest line that changed after that version, or MU_NONE; costs O(changes since) */
static inline uint32_t changelog_after(const struct changelog *c, uint64_t version)
{
    uint32_t found = MU_NONE;
    for (uint32_t line = mu_list_last(&c->list);
         line != MU_NONE && c->lines[line].version > version;
         line = mu_list_prev(MU_LINKS(c->lines, link), line)) {
        found = line;
    }
    return found;
}

/** @return the line that changed next after this one, or MU_NONE */
static inline uint32_t changelog_next(const struct changelog *c, uint32_t line)
{
    return mu_list_next(MU_LINKS(c->lines, link), line);
}

/** Goes through the lines that changed after that version, the oldest first. */
#define CHANGELOG_EACH(line, log, version)                                 \
    for (uint32_t line = changelog_after(log, version); (line) != MU_NONE; \
         (line) = changelog_next(log, line))

/* --- limiter.c ------------------------------------------------------------------------------- */

/*
 * What a sender is told of its mails: at once, and then at most every pause_ns.
 *
 * Bad news slows it down if it presses: it has a bounded number of mails without an answer, so that
 * the pause bounds its rate.  Good news, if it is short, goes with the next mail for it in that
 * time: one that answers many others is not woken once more for each answer.  No other sender waits
 * for anything.
 */

enum { LIMITER_BAD_PAUSE_NS = 100000000, LIMITER_GOOD_PAUSE_NS = 25000000 };

struct paced {
    uint64_t until_ns;   /* not told of it before this */
    struct mu_link link; /* there is something to tell then */
};

struct limiter {
    struct paced agents[REGISTRY_MAX];
    struct mu_list queue;
    uint64_t pause_ns; /* 0: nothing is told later */
};

/**
 * Says whether to tell an agent later: then limiter_next gives it when it is time.  From now on it
 * is told at most every pause_ns.
 */
bool limiter_holds(struct limiter *p, uint32_t agent, uint64_t now_ns);

/** It has been told with something else, or its name ends: nothing waits. */
void limiter_told(struct limiter *p, uint32_t agent, uint64_t now_ns);

/** @return the next agent that may be told now, or MU_NONE */
uint32_t limiter_next(struct limiter *p, uint64_t now_ns);

/** @return when limiter_next gives one, or UINT64_MAX */
uint64_t limiter_deadline_ns(const struct limiter *p);

/* --- alerts.c -------------------------------------------------------------------------------- */

/*
 * What goes wrong with mail, for watchers: told soon, and not more often than is useful.
 *
 * Events of one kind at one agent are counted together until they are told, and all that there
 * are are told at most every EVENTS_PAUSE_NS.
 */

enum { EVENTS_PAUSE_NS = 100000000 };

enum alert_kind { ALERT_BOX_FULL, ALERT_DROPPED, ALERT_OVER_QUOTA, ALERT_REFUSED, ALERT_KINDS };

struct alert {
    uint32_t agent;  /* whose box; the broker itself: its store, or its trust policy */
    uint32_t sender; /* of the last one */
    uint64_t count;  /* since it was told last; 0: nothing to tell */
    uint64_t at_ns;  /* of the last one, by the broker's clock */
    enum alert_kind kind;
    struct mu_link link; /* of those to be told */
};

struct alerts {
    struct alert all[REGISTRY_MAX * ALERT_KINDS];
    struct mu_list queue;
    uint32_t ready; /* so many of the queue may be told now */
    uint64_t pause_until_ns;
};

/** One more of a kind; agent and sender as in struct alert. */
void alerts_note(struct alerts *e, enum alert_kind kind, uint32_t agent, uint32_t sender,
                 uint64_t now_ns);

/** Gives what may be told now.  @return false when there is nothing */
bool alerts_next(struct alerts *e, uint64_t now_ns, struct alert *out);

/* --- validate.c ------------------------------------------------------------------------------ */

/*
 * What the border of the bus (bus/check.h) does not know: which words, names and numbers make sense
 * to a broker.
 */

/** @return whether what is said of an agent fits; its name may still be no good one */
bool validate_entry(const muster_Entry *e, bool of_a_broker);

/** @return whether a process may have that name, which is a DDS partition, too */
bool validate_process_name(const char *name);

/** Words that people and rules see; NULL when out of range. */
const char *validate_kind_word(muster_Kind kind);
const char *validate_state_word(muster_State state);

#endif
