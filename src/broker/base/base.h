/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file base.h
 * Time, versions, limits, the rules of the wire, the pool of mails, and the boxes in which they
 * wait.
 */
#ifndef MUSTER_BROKER_BASE_H
#define MUSTER_BROKER_BASE_H

#include "core/list.h"
#include "core/table.h"
#include "muster/limits.h"
#include "muster/result.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/** Takes note of the broker's clock; an earlier time than the last one counts as the last one. */
void clock_set_now(struct clock *c, uint64_t now_ns);

/** A run is at this time now, and goes on by steps of step_ns, or, if that is 0, with the broker's
 * clock. */
void clock_start(struct clock *c, uint64_t step_ns, uint64_t run_ns);

/** A step ends at this time: between the two, what is done happens in every run. */
void clock_advance(struct clock *c, uint64_t run_ns);
void clock_commit_begin(struct clock *c);
void clock_commit_end(struct clock *c);

/** @return whether steps move the time */
bool clock_by_steps(const struct clock *c);

/** @return whether what is done now takes effect only when the step ends */
bool clock_collects(const struct clock *c);

/** @return how long to wait for an answer: in simulated time, if steps move the clock */
uint64_t clock_patience_ns(const struct clock *c, uint64_t wall_ns, uint64_t steps);

/** @return the run's time; 0 when none has started */
uint64_t clock_run_ns(const struct clock *c);

/** @return the mail clock's time */
uint64_t clock_mail_ns(const struct clock *c);

/** While the broker's clock moves the time: when it shows this time of the mail clock or of the
 * run. */
uint64_t clock_now_of_mail_ns(const struct clock *c, uint64_t mail_ns);
uint64_t clock_now_of_run_ns(const struct clock *c, uint64_t run_ns);

/** @return nanoseconds since 1970 */
uint64_t clock_wall_ns(const struct clock *c);

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
uint64_t changelog_version(const struct changelog *c, uint32_t line);

/** A line is no more; changelog_gone tells of that, and nothing else does. */
void changelog_remove(struct changelog *c, uint32_t line);

/** @return a line that is no more, or was not for a while, each once; or MU_NONE */
uint32_t changelog_gone(struct changelog *c);

/** @return the oldest line that changed after that version, or MU_NONE; costs O(changes since) */
uint32_t changelog_after(const struct changelog *c, uint64_t version);

/** @return the line that changed next after this one, or MU_NONE */
uint32_t changelog_next(const struct changelog *c, uint32_t line);

/* --- limiter.c ------------------------------------------------------------------------------- */

/*
 * Slows down senders that press: a sender whose mail does not get through is told so at once, and
 * then at most every LIMITER_PAUSE_NS.
 *
 * A sender has a bounded number of mails without an answer, so that the pause bounds its rate.
 * No other sender waits for anything.
 */

enum { LIMITER_PAUSE_NS = 100000000 };

struct paced {
    uint64_t until_ns;   /* not told anything but good news before this */
    struct mu_link link; /* there is something to tell then */
};

struct limiter {
    struct paced *agents; /* one for each agent of the registry */
    struct mu_list queue;
};

void limiter_init(struct limiter *p, uint32_t agents);

/**
 * Says whether to tell an agent bad news later: then limiter_next gives it when it is time.  From
 * now on it is told such at most every LIMITER_PAUSE_NS.
 */
bool limiter_holds(struct limiter *p, uint32_t agent, uint64_t now_ns);

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

enum alert_kind { ALERT_BOX_FULL, ALERT_DROPPED, ALERT_OVER_SHARE, ALERT_REFUSED, ALERT_KINDS };

struct alert {
    uint32_t agent;  /* whose box; the broker itself: its store, or its trust policy */
    uint32_t sender; /* of the last one */
    uint64_t count;  /* since it was told last; 0: nothing to tell */
    uint64_t at_ns;  /* of the last one, by the broker's clock */
    enum alert_kind kind;
    struct mu_link link; /* of those to be told */
};

struct alerts {
    struct alert *all; /* ALERT_KINDS for each agent of the registry */
    struct mu_list queue;
    uint32_t ready; /* so many of the queue may be told now */
    uint64_t pause_until_ns;
};

void alerts_init(struct alerts *e, uint32_t agents);

/** One more of a kind. */
void alerts_note(struct alerts *e, const struct alert *event);

/** Gives what may be told now.  @return false when there is nothing */
bool alerts_next(struct alerts *e, uint64_t now_ns, struct alert *out);

/** @return the word for a kind, as tools see it */
const char *alerts_kind_word(enum alert_kind kind);

/* --- validate.c ------------------------------------------------------------------------------ */

/*
 * Checks of everything that comes from the network, made once; behind it, samples can be trusted
 * to be whole and bounded.
 */

/** @return whether s is a string of at most max bytes */
bool validate_string(const char *s, size_t max);

/** Checks the frame of a Registration; its entries are looked at one by one. */
bool validate_registration(const muster_Registration *r);

/** @return whether what is said of an agent fits; its name may still be no good one */
bool validate_entry(const muster_Entry *e, bool of_a_broker);

/** Checks the frame of an Up; its mails are looked at one by one. */
bool validate_up(const muster_Up *up);

/** @return whether a run can be at that step: if it goes by steps, they are counted and timed */
bool validate_step(int64_t step, uint64_t step_ns, bool by_steps);

/** @return whether these can be the processes of a run; its simulator is none of them */
bool validate_members(const char *simulator, char *const *processes, uint32_t count);

/** Checks all of a mail but its sender. */
bool validate_mail(const muster_Mail *m);

/** @return whether a process may have that name, which is a DDS partition, too */
bool validate_process_name(const char *name);

/** Words that people and rules see; NULL when out of range. */
const char *validate_kind_word(muster_Kind kind);
const char *validate_state_word(muster_State state);

/* --- quota.c --------------------------------------------------------------------------------- */

/*
 * A sender's fair share of what all of them use together.
 *
 * The rule is the dynamic threshold of A. K. Choudhury and E. L. Hahne, "Dynamic queue length
 * thresholds for shared-memory packet switches", IEEE/ACM Transactions on Networking 6(2), 1998,
 * with a factor of 1: a holder may hold as much as is left free.  So a lone sender
 * gets one half, two get a third each, and there is always room for one that has nothing yet.
 */

/* What a sender holds, or wants to. */
struct quota_use {
    uint32_t mails;
    uint32_t bytes; /* of the store */
    uint32_t posts; /* places in boxes */
};

enum quota_answer {
    QUOTA_FITS,
    QUOTA_FULL, /* all senders together leave no room */
    QUOTA_OVER  /* there may be room, but this sender has had its share */
};

/**
 * @param own    what the sender holds
 * @param all    what all hold together
 * @param want   what it wants besides
 * @param most   what all may hold together
 * @param floor  so much is within a sender's share whatever is free
 */
enum quota_answer quota_ask(const struct quota_use *own, const struct quota_use *all,
                            const struct quota_use *want, const struct quota_use *most,
                            const struct quota_use *floor);

void quota_add(struct quota_use *use, const struct quota_use *more);
void quota_subtract(struct quota_use *use, const struct quota_use *less);

/* The store's accounts.  Those inside a run are apart: what others send by the wall clock does
 * not change what a sender in it may send. */
enum quota_side { QUOTA_OUTSIDE, QUOTA_INSIDE, QUOTA_SIDES };

/* What both sides can hold together: others may have filled the store when a run begins, and
 * that has its half all the same. */
enum {
    QUOTA_MAILS_MAX = MU_MAILS_MAX + MU_MAILS_MAX / 2,
    QUOTA_BYTES_MAX = MU_MAIL_BYTES_MAX + MU_MAIL_BYTES_MAX / 2,
    QUOTA_POSTS_MAX = MU_POSTS_MAX + MU_POSTS_MAX / 2
};

struct quota_accounts {
    struct quota_use *senders[QUOTA_SIDES]; /* one for each agent of the registry */
    struct quota_use all[QUOTA_SIDES];
};

void quota_init(struct quota_accounts *a, uint32_t agents);

/**
 * Books a mail on its sender's account, if that may be.
 *
 * @param halved  both sides are in use, and have one half of the store each: the run never
 * has more
 * @param urgent  a directive: it has no share, and a reserve that no other mail can take
 */
enum quota_answer quota_book(struct quota_accounts *a, enum quota_side side, uint32_t sender,
                             const struct quota_use *want, bool halved, bool urgent);

/**
 * Books a mail that had its room in an earlier life, on whichever account has room for it.
 *
 * @param side  out: that account
 * @return false: neither has
 */
bool quota_restore(struct quota_accounts *a, enum quota_side *side, uint32_t sender,
                   const struct quota_use *want);

/** Takes back some of what was booked. */
void quota_unbook(struct quota_accounts *a, enum quota_side side, uint32_t sender,
                  const struct quota_use *less);

/* --- pool.c ---------------------------------------------------------------------------------- */

/*
 * The mails themselves: each is kept once, however many receivers it has.
 *
 * The memory, for mails that wait in boxes and for those that wait for the end of a step, is
 * cut into slabs; a slab holds records of one size class, from its
 * first use until the last of them goes.  Nothing is touched before it is needed, so that an idle
 * broker stays small.
 */

/* Text in a sample that is about to be written. */

enum {
    POOL_SLAB_BYTES = 64 * 1024,
    POOL_SLABS = (QUOTA_BYTES_MAX + MU_STEP_BYTES_MAX) / POOL_SLAB_BYTES,
    POOL_CLASSES = 8,
    POOL_RECORD_MAX = 21824, /* bytes that the largest mail takes: three to a slab */
};

/* The two schedules that a mail may stand in; see timers.h. */
enum timers_kind { TIMERS_DUE, TIMERS_EXPIRY, TIMERS_KINDS };

/* What the sender of a mail was told of it: nothing, that it waits, or the last word. */
enum mail_told { TOLD_NOTHING, TOLD_STORED, TOLD_LAST, TOLD_STATES };
enum mail_told_event { TOLD_STORES, TOLD_ENDS, TOLD_EVENTS };

/* The worst that became of a mail so far, over all its receivers. */
enum mail_fate { FATE_TAKEN, FATE_PASSED_ON, FATE_EXPIRED, FATE_DROPPED, FATES };
enum mail_fate_event { FATE_PASSES, FATE_EXPIRES, FATE_DROPS, FATE_EVENTS };

/* Whether a mail has a row on disk, and whether the next commit is to write or change that. */
enum mail_durable {
    DURABLE_NOT,
    DURABLE_MARKED,
    DURABLE_WRITTEN,
    DURABLE_MARKED_AGAIN,
    DURABLE_STATES
};
enum mail_durable_event {
    DURABLE_MARKS,
    DURABLE_COMMITS,
    DURABLE_RESTORES,
    DURABLE_UNDOES,
    DURABLE_EVENTS
};

struct mail {
    muster_Mail letter;           /* its strings lie behind this record */
    struct mail *next;            /* in a list of mails that wait for the end of a step */
    struct mail *journal_next;    /* in the list of what is to be written to disk */
    struct mail *journal_same;    /* in a chain of durable mails whose names have one hash */
    uint64_t row;                 /* on disk; 0: it is not durable */
    uint64_t at_ns[TIMERS_KINDS]; /* of the run; of the broker's clock */
    uint32_t place[TIMERS_KINDS]; /* in the schedule's heap; MU_NONE: not there */
    uint64_t order;               /* in which mails were routed */
    uint32_t sender;              /* an index of the registry */
    uint32_t only;        /* its one receiver, by another broker's word; MU_NONE: as dst says */
    uint32_t kept_for;    /* the one that a step keeps it for; MU_NONE: for many, or unknown */
    uint32_t payer;       /* whose share it takes: the sender's, or the asker's */
    struct mu_list posts; /* its places in boxes */
    uint32_t unsettled;   /* receivers that have neither acknowledged it nor let it expire */
    uint32_t veiled;      /* of them, outside a run that the sender is in */
    uint32_t uses;        /* freed at 0 */
    uint32_t bytes;
    uint32_t size_class;
    struct mail *older, *newer;     /* of those that wait in boxes; see arrivals.h */
    uint64_t came_ns;               /* on the mail clock */
    struct quota_use booked;        /* on its sender's account */
    struct quota_use booked_veiled; /* for those outside, on its sender's account there */
    uint8_t side;                   /* enum share_side: the account on which it is booked */
    uint8_t answer;                 /* muster_Outcome: the last word, if its sender was told that */
    enum mail_told told : 8;
    enum mail_fate fate : 8;
    enum mail_durable durable : 8;
    bool tell_stored;    /* its sender is told that it is stored, once it is on disk */
    bool stored_ends_it; /* that is then the last word */
};

struct pool_slab {
    struct mu_link link; /* in the list of its class's slabs with room */
    uint32_t size_class;
    uint32_t live;   /* records in use */
    uint32_t carved; /* records ever used since the class took it */
    void *free;      /* records given back */
};

struct pool {
    unsigned char *memory;
    struct pool_slab *slabs;
    struct mu_pool slabs_pool;
    struct mu_list open[POOL_CLASSES];
    uint32_t mails;
};

void pool_init(struct pool *s);

/** Copies a mail that the border has let through, with one use.  @return NULL when full */
struct mail *pool_put(struct pool *s, const muster_Mail *letter);

/** @return the bytes of the store that a mail takes */
uint32_t pool_bytes(const struct mail *m);

void pool_keep(struct mail *m);

/** Ends one use; the last one frees the mail. */
void pool_release(struct pool *s, struct mail *m);

/** @return the text, for a member of a sample: idlc makes none const, and nothing is written there
 */
static inline char *sample_text(const char *text)
{
    return (char *)(uintptr_t)text;
}

/**
 * How it stands with a mail that a process still waits for, for the store.
 *
 * @return what its sender was told for good, or what it will be told; "" for nothing yet
 */
const char *pool_mail_standing(const struct mail *m);

/** The same of a mail that comes back from the store.  @return false: there is no such word */
bool pool_mail_go_on(struct mail *m, const char *word);

/* --- mail_states.c --------------------------------------------------------------------------- */

/** @return whether the event is news to the sender of the mail */
bool mail_told_on(struct mail *m, enum mail_told_event event);

void mail_fate_on(struct mail *m, enum mail_fate_event event);

/** @return the outcome that the fate of a mail stands for, if all its receivers are through */
muster_Outcome mail_outcome(const struct mail *m);

/** @return whether the state has changed */
bool mail_durable_on(struct mail *m, enum mail_durable_event event);

/** @return whether the mail has a row on disk */
bool mail_is_written(const struct mail *m);

/* --- mailbox_share.c ------------------------------------------------------------------------- */

/*
 * What each sender has in each box: a share for each pair of them.
 *
 * A pair stands here as long as the sender has a post in the box, so that there are never more
 * pairs than posts.  They are found by a hash that keeps the pairs of one box close together:
 * little memory is touched while there are few.
 */

/* The queues of mail that waits, apart from directives: low, normal, high. */
enum { MAILBOX_SHARE_QUEUES = 3 };

/* A list of posts, and what they take. */
struct post_queue {
    struct mu_list posts;
    uint32_t bytes;
};

struct mailbox_share {
    uint32_t box, sender;
    uint32_t next; /* with the same hash */
    struct quota_use use;
    struct post_queue waiting[MAILBOX_SHARE_QUEUES]; /* the sender's part of the box's queues */
};

struct mailbox_shares {
    struct mailbox_share *at; /* QUOTA_POSTS_MAX of them */
    struct mu_pool pool;
    uint32_t *heads; /* of the lists of each hash: an index and one, or 0 */
    uint32_t mask;
};

void mailbox_share_init(struct mailbox_shares *p);

/** @return the pair, or MU_NONE: the sender has nothing there */
uint32_t mailbox_share_find(const struct mailbox_shares *p, uint32_t box, uint32_t sender);

/** Finds a pair or enters it. */
uint32_t mailbox_share_get(struct mailbox_shares *p, uint32_t box, uint32_t sender);

/** Forgets a pair whose use is nothing. */
void mailbox_share_drop(struct mailbox_shares *p, uint32_t pair);

/* --- mailbox.c ------------------------------------------------------------------------------- */

/*
 * A box for each agent: what waits for it, what was handed out, and what it has acknowledged.
 *
 * A post is a mail's place in one box.  It waits in the urgent queue (directives) or in that of its
 * priority, is then handed out, which gives it the box's next number, and goes when it is
 * acknowledged.  A number that has gone out on the network stays with its mail for ever.
 *
 * A box has a limit in mails and bytes; mailbox_room.h says what happens at it.
 */

/* Handed out beyond MU_WINDOW_MAX, and for directives alone: they reach an agent that has stopped
 * acknowledging its mail.  And so many have room in a box that other mail has filled. */
enum { MAILBOX_RESERVE = 8 };

/* What may be handed out just now. */
enum mailbox_gate { GATE_SHUT, GATE_URGENT, GATE_OPEN };

enum post_list { POST_HELD, POST_LOW, POST_NORMAL, POST_HIGH, POST_URGENT, POST_FLIGHT };

/* The lists that a post stands in at the same time. */
enum post_links { LINKS_BOX, LINKS_PAIR, LINKS_MAIL, LINKS };

struct post {
    struct mail *mail;
    struct mu_link
        links[LINKS]; /* in its list of the box, that of the pair, and of its mail's posts */
    uint32_t agent;
    uint32_t pair; /* of box and sender */
    uint8_t list;  /* enum post_list */
    bool sent;     /* has gone out on the network */
    bool veiled;   /* see struct mail */
};

/* What a box may hold, and what happens when it is full. */
struct box_limits {
    muster_BoxPolicy policy;
    uint32_t mails, bytes;
};

struct box {
    bool begun;
    struct post_queue lists[POST_FLIGHT + 1]; /* POST_HELD: its count alone */
    uint64_t acked;                           /* the number before the first one in flight */
    uint32_t out;     /* the first in flight that is to go out (again); or MU_NONE */
    uint32_t written; /* how many in flight stand before it */
    uint64_t progress_ns;
    uint32_t unsaved;         /* mails of the store, acknowledged since */
    uint64_t unsaved_commits; /* so many commits had been made; see journal_room */
    struct mu_link watch;     /* of the boxes that wait for an acknowledgement */
    struct quota_use use;     /* waiting, held and in flight */
    struct box_limits limits; /* 0: the broker's */
};

struct mailbox {
    struct post *posts; /* QUOTA_POSTS_MAX of them */
    struct mu_pool posts_pool;
    uint64_t base;          /* every box counts from here */
    struct box *boxes;      /* one for each agent of the registry */
    struct mu_list watched; /* the box without progress for longest is the first */
    struct mailbox_shares shares;
    struct box_limits limits; /* of boxes that have none of their own */
};

void mailbox_init(struct mailbox *m, uint32_t agents);

/** @return the box of an agent; it begins if it has not, which is only for code that puts mail into
 * it: another broker is told where (names_tell_number) */
struct box *mailbox_box(struct mailbox *m, uint32_t agent);

/** An agent's name ends, whose box is empty.  Boxes that begin later count from beyond its numbers:
 * a receiver that comes back drops none of them as had. */
void mailbox_end(struct mailbox *m, uint32_t agent);

/** @return whether the agent's box was ever used: memory of others stays untouched */
static inline bool mailbox_is_begun(const struct mailbox *m, uint32_t agent)
{
    return m->boxes[agent].begun;
}

/**
 * Sets the limits of all boxes that have none of their own.
 *
 * @param mails  at most MU_BOX_MAX; 0: that many
 * @param bytes  at most MU_BOX_BYTES_MAX; 0: that many
 */
void mailbox_set_defaults(struct mailbox *m, muster_BoxPolicy policy, uint32_t mails,
                          uint32_t bytes);

/**
 * Sets the limits of one box; what is in it already stays.
 *
 * @param policy  BOX_REFUSE_NEW: the broker's default
 * @param mails   0: the broker's default
 * @param bytes   0: the broker's default
 */
void mailbox_set_limits(struct mailbox *m, uint32_t agent, muster_BoxPolicy policy, uint32_t mails,
                        uint32_t bytes);

/** @return the limits of a box, its own or the broker's */
struct box_limits mailbox_limits(const struct mailbox *m, const struct box *box);

/** @return the queue in which a mail waits */
enum post_list mailbox_queue(const struct mail *mail);

/** @return the post behind this one in its list of the box, or MU_NONE */
uint32_t mailbox_next(const struct mailbox *m, uint32_t post);

/** @return the next post of the same mail, or MU_NONE */
uint32_t mailbox_sibling(const struct mailbox *m, uint32_t post);

/** @return the box without progress for longest, of those that wait for an acknowledgement */
uint32_t mailbox_watched(const struct mailbox *m);

/**
 * Puts a mail into a box, or holds it until mailbox_admit, whatever the box's limits say.
 *
 * @return MU_OK, or MU_FULL: there are no more posts
 */
mu_result mailbox_put(struct mailbox *m, uint32_t agent, struct mail *mail, bool held);

/** The post that a mail was given last is for one outside the run that its sender is in. */
void mailbox_veil(struct mailbox *m, struct mail *mail);

/** A held post may be handed out from now on. */
void mailbox_admit(struct mailbox *m, uint32_t post);

/** Takes a post out that is not in flight; its mail remains. */
void mailbox_withdraw(struct mailbox *m, uint32_t post);

/**
 * Hands out as much as the gate and the window allow.
 *
 * @param written  so many mails that are on disk at most; those behind them wait, too
 */
void mailbox_hand_out(struct mailbox *m, uint32_t agent, enum mailbox_gate gate, uint32_t written);

/** @return whether this mail is what would be handed out next, if the gate is open */
bool mailbox_next_is(struct mailbox *m, uint32_t agent, const struct mail *mail);

/** Hands out that mail alone. */
void mailbox_hand_next(struct mailbox *m, uint32_t agent, const struct mail *mail);

/** Takes back what was handed out but has never gone out. */
void mailbox_take_back(struct mailbox *m, uint32_t agent);

/**
 * The next count posts from box->out on have gone out.
 *
 * @return how many of them not for the first time
 */
uint32_t mailbox_mark_written(struct mailbox *m, uint32_t agent, uint32_t count);

/** Everything in flight is to go out again. */
void mailbox_repeat(struct mailbox *m, uint32_t agent);

/** @return whether the receiver can have had this number */
bool mailbox_number_valid(const struct mailbox *m, uint32_t agent, uint64_t number);

/** @return the highest number that was handed out, or the one before the first */
uint64_t mailbox_last_number(const struct mailbox *m, uint32_t agent);

/** Takes out the oldest post in flight, as acknowledged.  @return its mail */
struct mail *mailbox_pop(struct mailbox *m, uint32_t agent);

/** The box has made progress now, or is to be watched from now on, if anything is in flight. */
void mailbox_watch(struct mailbox *m, uint32_t agent, uint64_t now_ns);
void mailbox_unwatch(struct mailbox *m, uint32_t agent);

/* --- mailbox_room.c -------------------------------------------------------------------------- */

/*
 * Whether a box has room for a mail, and what has to go if not.
 *
 * A sender has a fair share of each box (quota.h).  Where the box drops mail when it is full,
 * a sender over its share makes room with its own mail, so that a flood costs other senders
 * nothing; only a box that is full of fair shares drops the mail of others.
 *
 * Only ordinary mail that waits is dropped: never what is in flight, held for a time, or a
 * directive.
 */

enum mailbox_room {
    MAILBOX_ROOM_FITS,
    MAILBOX_ROOM_DROP, /* another mail has to go first; then ask again */
    MAILBOX_ROOM_FULL,
    MAILBOX_ROOM_OVER_SHARE
};

/**
 * Says whether a mail may be put into a box.
 *
 * @param victim  out, with MAILBOX_ROOM_DROP: the post that has to go
 */
enum mailbox_room mailbox_room_ask(struct mailbox *m, uint32_t agent, const struct mail *mail,
                                   uint32_t *victim);

/* --- receipts.c ------------------------------------------------------------------------------ */

/* What senders are still to be told of their mails. */

/* Receipts that wait for one sender; a sender is bound to have fewer mails unanswered. */
enum { RECEIPTS_EACH_MAX = 2 * MU_OUTBOX_MAX };

struct receipt {
    uint64_t first_seq, last_seq;
    muster_Outcome result;
    struct mu_link link;
};

struct receipts {
    struct receipt *at; /* MU_MAILS_MAX of them */
    struct mu_pool pool;
    struct mu_list *queues; /* one for each agent of the registry */
    uint32_t *told;         /* for each: so many of its oldest are out, and may have to go again */
    uint64_t lost;          /* receipts that were not told, for want of room */
};

void receipts_init(struct receipts *r, uint32_t agents);

/**
 * Adds an outcome; it joins the sender's last one if that is its neighbour and the same.
 *
 * Where there is no room a receipt is lost, and counted: the sender's oldest, or this one. A sender
 * that waits for it sends its mail again, and is told then.
 */
void receipts_add(struct receipts *r, uint32_t agent, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result);

/** @return how many receipts wait for an agent */
uint32_t receipts_count(const struct receipts *r, uint32_t agent);

/** @return the receipt behind another one, or (after NULL) the agent's first; or NULL */
const struct receipt *receipts_next(const struct receipts *r, uint32_t agent,
                                    const struct receipt *after);

/** Removes the oldest count receipts of an agent. */
void receipts_drop(struct receipts *r, uint32_t agent, uint32_t count);

/** The oldest count receipts of an agent are out: they are kept until it is known to have them. */
void receipts_tell(struct receipts *r, uint32_t agent, uint32_t count);

/** The agent has what it was told: that is removed. */
void receipts_heard(struct receipts *r, uint32_t agent);

/* --- timers.c -------------------------------------------------------------------------------- */

/* Mails in order of a time: when they are due, or when they expire. */

struct timers {
    struct mail **heap; /* QUOTA_MAILS_MAX of them: a mail stands here once */
    uint32_t count;
    enum timers_kind kind;
};

void timers_init(struct timers *s, enum timers_kind kind);

/** Enters a mail for m->at_ns of this kind; equal times go by m->order. */
void timers_add(struct timers *s, struct mail *m);

/** Takes a mail out, if it is in. */
void timers_remove(struct timers *s, struct mail *m);

/** @return the earliest mail, or NULL */
struct mail *timers_first(const struct timers *s);

/* --- arrivals.c ------------------------------------------------------------------------------ */

/* Mails that wait in boxes, in the order in which they came: the oldest is always at hand. */

struct arrivals {
    struct mail *oldest, *newest;
};

/** A mail waits from now on; mail_ns is the mail clock's time and never less than the last. */
void arrivals_add(struct arrivals *a, struct mail *m, uint64_t mail_ns);

/** It waits no more. */
void arrivals_remove(struct arrivals *a, struct mail *m);

/** @return how long the oldest has waited; 0 when none waits */
uint64_t arrivals_oldest_ns(const struct arrivals *a, uint64_t mail_ns);

#endif
