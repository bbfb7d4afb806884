/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file facts.h
 * What the engine is told from outside, as facts: percepts, mail, events of the agent's life.
 */
#ifndef MUSTER_MIND_FACTS_H
#define MUSTER_MIND_FACTS_H

#include "core/sensors.h"
#include "mind/engine/engine.h"

enum {
    MESSAGES_STEPS = 50,         /* the age at which a message fact is dropped */
    MESSAGES_MAX = 1024,         /* message facts; one more drops the oldest */
    MAILBOX_MAX = 1024,          /* mail facts; one more is refused */
    MAIL_RING_MAX = 1024,        /* mails for (getmsg) without a mail fact */
    MAIL_RING_BYTES = 256 << 10, /* of their contents, each with its zero byte */
    EVENTS_REFUSED_MAX = 64      /* facts of refused changes; one more drops the oldest */
};

/* A mail as a message fact.  Links are indices into the pool; 0 is no entry. */
struct message {
    struct fact *fact;
    SYMBOL_HN *from;
    unsigned short first_type; /* of the first field: one equal to it supersedes this mail */
    void *first;
    uint64_t id, step;
    uint16_t older, newer, chain;
};

enum { MESSAGES_CHAINS = 256 };

struct messages {
    struct message at[MESSAGES_MAX + 1];
    uint16_t chains[MESSAGES_CHAINS];
    uint16_t oldest, newest, free;
};

/* Mail without facts, kept for (getmsg): a ring of entries, and a ring of their contents. */
struct mail_ring_entry {
    uint64_t id;
    SYMBOL_HN *from;
    uint32_t at, bytes; /* of its content */
    bool clips;         /* the content is a list of fields */
};

struct mail_ring {
    struct mail_ring_entry mails[MAIL_RING_MAX];
    char bytes[MAIL_RING_BYTES];
    uint32_t first, count;
};

/* The lists of a percept, and their facts: one for a plain list, one for each record. */
#define PERCEPT_ELEMENTS(id, senses, type, list, count, most, ...) type list[most];
#define PERCEPT_FACTS(id, senses, type, list, count, most, ...) \
    struct fact *list[_Generic((type *)0, float * : 1, default : (most))];
struct percept_elements {
    MU_CHANNELS(PERCEPT_ELEMENTS)
};
struct percept_facts {
    MU_CHANNELS(PERCEPT_FACTS)
};

/* The list of one row of mu_channels. */
struct percept_list {
    void *elements;
    struct fact **facts;
    struct deftemplate *relation;
};

/* Whether a mind has a body, as its last percept tells. */
enum percept_body { PERCEPT_BODY_UNKNOWN, PERCEPT_BODY, PERCEPT_NO_BODY, PERCEPT_BODIES };

/* A mind and all that it was told. */
struct mind_inputs {
    struct mind mind; /* first */
    uint64_t step;

    /* percepts */
    struct mu_percept percept;
    struct percept_elements elements;
    struct percept_facts list_facts;
    struct percept_list lists[MU_CHANNEL_COUNT];
    enum percept_body body;
    uint32_t senses_named; /* enum mu_sense: sensors whose functions rules call */
    struct deftemplate *time, *tick, *position;
    struct fact *time_fact;     /* NULL: no rule looks at it */
    struct fact *position_fact; /* without a body that of the tick */
    struct multifield *timers;  /* while (reset) goes on */
    bool ring_unseen; /* the ring's fact is left out: no rule has a pattern of it, and no query has
                         looked for it */
    long long ring_number; /* the number that this fact would bear */

    /* mail */
    struct deftemplate *message, *mail;
    struct messages *messages;
    struct fact *mails[MAILBOX_MAX]; /* mail facts; rules may have retracted some */
    size_t mail_count;
    struct mail_ring *mail_ring;
    bool rules_getmsg; /* a construct calls (getmsg) */
    char *scratch;     /* MU_CONTENT_MAX + 1 bytes: a mail's content */

    /* the agent's life */
    struct deftemplate *event;
    bool pending[MU_EVENTS]; /* become facts in the next step */
    struct fact *events[MU_EVENTS];
    struct fact *refused[EVENTS_REFUSED_MAX]; /* a ring */
    size_t refused_next;
};

static inline struct mind_inputs *inputs_of(const struct mind *m)
{
    return (struct mind_inputs *)(uintptr_t)m;
}

/* inputs.c */

/** Allocates at start-up. */
void facts_reserve(struct mind *m);

/** Builds the templates that C code knows.  @return whether CLIPS has taken them */
bool facts_build(struct mind *m);

/* fact.c */

/** Retracts a fact if it is still there, and gives the reference back. */
void fact_retract(struct mind *m, struct fact **fact);

/**
 * Asserts an ordered fact of one multifield.
 * @return the fact, referenced for the caller; NULL: CLIPS refused it
 */
struct fact *fact_assert(struct mind *m, struct deftemplate *template, struct multifield *fields);

/**
 * @return whether a pattern or a query of some construct uses facts of that template, or a person
 * watches them
 */
bool fact_is_used(const struct deftemplate *template);

/* sensors.c */

/**
 * Notes that rules use the facts or the function of that name: its sensor is wanted from now on.
 */
void sensors_note(struct mind *m, const char *word);

/** @return bits of enum mu_sense: the sensors that rules use */
uint32_t sensors_wanted(const struct mind *m);

/** @return the colour's name, or #rrggbb in bytes */
const char *sensors_color(uint32_t rgb, char bytes[8]);

/** Writes the fields of some elements of a list, in the units of rules. */
void sensors_set(struct mind *m, const struct mu_channel *c, const void *elements, size_t count,
                 struct multifield *fields, size_t at);

/** Writes time s, x mm, y mm, speed mm/s, turn rate deg/s, compass deg in (-180, 180]. */
void sensors_set_position(const struct mu_percept *p, double out[6]);

/* percept.c */

/** @return how many facts a list may have now; missing ones are NULL */
size_t percept_fact_count(const struct mind *m, size_t number);

/** Asserts the percept facts that were left out, for a caller that looks at all facts. */
void percept_show(struct mind *m);

/** Replaces the percept and its facts. */
void percept_take(struct mind *m, const struct mu_percept *p);

/** Drops the percept and its facts; the time stays. */
void percept_lose(struct mind *m, uint64_t time_ns);

/** Ties the lists to their elements and facts, and tells (reset) of them. */
void percept_install(struct mind *m);

/* timers.c */

/** Lets timers outlive (reset). */
void timers_install(struct mind *m);

/** Sets all timers so much later, as the steps have another clock. */
void timers_move(struct mind *m, double later_s);

/* messages.c */
struct messages *messages_reserve(void);
void messages_install(struct mind *m);

/**
 * Makes a mail's content a message fact, which supersedes the sender's earlier one with the same
 * first word.
 */
void messages_add(struct mind *m, uint64_t id, SYMBOL_HN *from, struct multifield *fields);

/**
 * Makes a message the newest, and sets its links.  Takes the reference to its fact over.
 *
 * @return false: there is no room
 */
bool messages_enter(struct mind *m, const struct message *entry);

/** Drops the message fact of a mail, if it still stands. */
void messages_forget(struct mind *m, uint64_t id);

/** Drops message facts of MESSAGES_STEPS steps and more. */
void messages_age(struct mind *m);

/* mailbox.c */
void mailbox_install(struct mind *m);

/** As mind_take_mail. */
MU_MUST_USE mu_result mailbox_take(struct mind *m, const struct mind_mail *mail);

/** @return a mail's content as fields, typed, or as one string; *list: it is a list of fields */
struct multifield *mailbox_content(struct mind *m, const struct mind_mail *mail, bool *list);

/** (getmsg), and its parser, which notes the construct that calls it. */
void mailbox_getmsg(void *env, DATA_OBJECT *out);
struct expr *mailbox_parse_getmsg(void *env, struct expr *top, const char *source);

/* mail_ring.c */
struct mail_ring *mail_ring_reserve(void);
void mail_ring_install(struct mind *m);

/**
 * Keeps a mail for (getmsg).  Drops the oldest to make room, unless some construct calls (getmsg).
 *
 * @return MU_OK, or MU_FULL: refused
 */
mu_result mail_ring_put(struct mind *m, const struct mind_mail *mail, bool clips);

/** @return the oldest, or NULL; it and its content stay until it is dropped */
const struct mail_ring_entry *mail_ring_first(const struct mind *m, const char **content);

void mail_ring_drop(struct mind *m);

/* events.c */

/** Asserts the events since the last step. */
void events_assert(struct mind *m);

/** @return whether the event's fact stands, and a rule is about to fire for it */
bool events_are_awaited(struct mind *m, enum mu_event event);

/** As mind_refused. */
void events_refuse(struct mind *m, const char *change, const char *reason);

#endif
