/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_mind.h
 * What the CLIPS files of the agent share.  No other file includes this one or clips.h.
 */
#ifndef MUSTER_AGENT_CLIPS_MIND_H
#define MUSTER_AGENT_CLIPS_MIND_H

#include "core/random.h"
#include "core/sensors.h"
#include "mind/engine/port.h"
#include "mind/engine/syntax.h"
#include "mind/mind.h"
#include "muster/limits.h"

#include <clips.h>
#include <limits.h>
#include <setjmp.h>
#include <tmpltutl.h>

enum {
    CLIPS_DEPTH_MAX = 1000,         /* functions that have not returned */
    CLIPS_STACK_MAX = 3 << 20,      /* bytes of stack below the entry */
    CLIPS_MEMORY_MAX = 64 << 20,    /* bytes that CLIPS holds */
    CLIPS_MEMORY_BURST = 384 << 20, /* more is not given to it, even in the middle of one call */
    CLIPS_FAILING_MAX = 64,         /* different rules whose failures are counted */
    CLIPS_MEMORY_SPARE = 8 << 20,   /* more of them for a line, so that a person can tidy up */
    CLIPS_PRINT_MAX = 64 * 1024,    /* bytes that one step may print */
    CLIPS_LINE_MAX = 16384,         /* bytes of a console line */
    LOAD_FILE_MAX = 1 << 20,        /* bytes of a rule file */
    LOAD_DEEP_MAX = 16,             /* files that extend each other */
    CLIPS_SAID_MAX = 2048,          /* bytes kept of an error */
    STEP_FIRED_MAX = 8192,          /* bytes of names of the rules fired in a step */
    MESSAGES_STEPS = 50,            /* a message fact that is so old goes */
    MESSAGES_MAX = 1024,            /* message facts; beyond, the oldest goes */
    MAILBOX_MAX = 1024,             /* mail facts; beyond, mail is refused */
    MAIL_RING_MAX = 1024,           /* mails for (getmsg) that have no mail fact */
    MAIL_RING_BYTES = 256 << 10,    /* of their contents, each with a zero at its end */
    CLIPS_SHOWN_MAX = 64,           /* different errors of rules that were shown */
    LAYERS_HANDLERS_MAX = 32,       /* handlers of layers, in all of them together */
    CLIPS_DIARY_MAX = 16384,        /* bytes of what went on in a step, for recordings */
    CLIPS_DIARY_AGENDA = 32,        /* activations in it */
    CLIPS_DIARY_LINE = 1024,        /* bytes of a person's line in it */
    EVENTS_REFUSED_MAX = 64         /* facts of refused changes; beyond, the oldest goes */
};

/* Where what CLIPS prints goes. */
enum clips_mode { CLIPS_MODE_QUIET, CLIPS_MODE_FIRE, CLIPS_MODE_LINE };

/* A mail that stands as a message fact.  Indices into the pool; 0 is no entry. */
struct message {
    struct fact *fact;
    SYMBOL_HN *from;
    unsigned short first_type; /* the first field, for "a later mail of the same first word" */
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

/* A mail that has no fact, kept for (getmsg): a ring of entries, and one of their contents. */
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

/* A deffunction that is the handler of a layer. */
struct layers_handler {
    uint32_t layer;
    SYMBOL_HN *function;
};

/* How often a rule has failed. */
struct clips_failing {
    char rule[MU_FIELD_MAX + 1]; /* its name, or how that begins */
    uint32_t count;
};

struct clips_places; /* clips_place.c */

enum { HEAP_SIZES = 16 }; /* of small blocks */

/* What CLIPS has of memory: heap.c. */
struct heap {
    struct heap_item *large, *full, *pages[HEAP_SIZES]; /* pages that have room, by size */
    size_t held;                                        /* bytes in all blocks */
};

/* Globals that C code reads; clips_env.c says what they are. */
enum clips_global {
    CLIPS_SONAR_MARGIN,
    CLIPS_SONAR_CLIP,
    CLIPS_FOLLOW_DISTANCE,
    CLIPS_CARE,
    CLIPS_GLOBALS
};

/* What a fact that is asserted now is to the diary. */
enum clips_diary_fact {
    CLIPS_DIARY_CAUSED, /* of the cause above it */
    CLIPS_DIARY_SENSED, /* of this step's percept */
    CLIPS_DIARY_SHOWN   /* of a percept before: somebody looks now, who is not its cause */
};

/* The lists of a percept, and the facts of each: a plain list is one. */
#define PERCEPT_ELEMENTS(id, senses, type, list, count, most, ...) type list[most];
#define PERCEPT_FACTS(id, senses, type, list, count, most, ...) \
    struct fact *list[_Generic((type *)0, float * : 1, default : (most))];
struct percept_elements {
    MU_CHANNELS(PERCEPT_ELEMENTS)
};
struct percept_facts {
    MU_CHANNELS(PERCEPT_FACTS)
};

/* What belongs to one row of mu_channels. */
struct percept_list {
    void *elements;
    struct fact **facts;
    struct deftemplate *relation;
};

struct mind {
    struct port_cost cost; /* first: port.h */
    void *env;             /* NULL: there is none, or it broke */
    struct heap heap;
    struct mind_options options;
    char name[MU_NAME_MAX + 1], folder[PATH_MAX], file[PATH_MAX]; /* that the options point to */
    struct mu_random random;
    uint64_t asked; /* questions so far, for reply-with */

    /* percepts */
    struct mu_percept percept;
    struct percept_elements elements;
    struct percept_facts list_facts;
    struct percept_list lists[MU_CHANNEL_COUNT];
    bool sensed;
    uint32_t senses_named; /* enum mu_sense: by calls of their functions */
    uint64_t step;
    struct deftemplate *position, *message, *event, *mail;
    struct defglobal *globals[CLIPS_GLOBALS];
    struct fact *position_fact;
    bool ring_unseen; /* no rule has a pattern of the ring's fact, and nobody has looked for it */
    long long ring_number; /* that it would bear */

    /* mail */
    struct messages *messages;
    struct fact *mails[MAILBOX_MAX]; /* mail facts; rules may have retracted some */
    size_t mail_count;
    struct mail_ring *parked;
    bool rules_getmsg; /* a construct calls (getmsg) */
    bool rules_speak;  /* one that is not of the library sends mail, or may */

    struct layers_handler handlers[LAYERS_HANDLERS_MAX]; /* the youngest last */
    size_t handler_count;
    const struct mind_mail *handled; /* by a handler that runs, or NULL */

    /* the agent's life */
    bool pending[MU_EVENTS]; /* become facts in the next step */
    struct fact *events[MU_EVENTS];
    struct fact *refused[EVENTS_REFUSED_MAX]; /* a ring */
    size_t refused_next;

    /* what the rules do in this step */
    struct mind_act act;
    char fired_bytes[STEP_FIRED_MAX];
    struct mu_text fired;
    const char *rule; /* that fired last */
    bool firing, sense_again;
    struct mind_travel travel;

    /* its own life */
    enum mind_wish wish;
    uint32_t wish_rules;
    char stands[MU_FIELD_MAX + 1]; /* the rule with a breakpoint that it stopped before last */
    bool passes;                   /* that rule may fire once all the same */

    /* guards */
    uint64_t worked; /* units of the cost, when the port was told last */
    long memory_max;
    const char *stopped;  /* which guard, or NULL */
    const char *stack;    /* at the entry */
    jmp_buf shelter;      /* in the function of mind.h that called into CLIPS */
    bool sheltered;       /* it is in CLIPS, and the shelter is good */
    uint32_t allocations; /* of CLIPS, so far */
    const char *broken;   /* which guard: its environment is gone; NULL: it is not */
    char lost[224];       /* why, in words */
    struct clips_failing failing[CLIPS_FAILING_MAX];
    size_t failing_count;
    uint64_t stops; /* by guards */
    char reason[MU_ATTRIBUTES_MAX + 1];

    /* output */
    enum clips_mode mode;
    struct mu_text *out; /* of a line */
    size_t printed;
    char said_bytes[CLIPS_SAID_MAX];
    struct mu_text said; /* errors and warnings of this call */
    uint64_t shown[CLIPS_SHOWN_MAX];
    size_t shown_count;

    /* for recordings */
    char diary_bytes[CLIPS_DIARY_MAX];
    struct mu_text diary;
    uint32_t diary_lost; /* lines for which there was no room */
    enum clips_diary_fact diary_fact;

    /* values of ?*my-name* and ?*mate* while (reset) runs */
    DATA_OBJECT kept[2];

    /* loading */
    char *text; /* a stack of the files being read */
    size_t text_used;
    char *form; /* one form, rewritten */
    const char *files[LOAD_DEEP_MAX];
    size_t files_deep;
    long error_line;
    struct clips_places *places; /* of what was loaded */

    char *scratch; /* MU_CONTENT_MAX + 1 bytes: a mail's content */
};

/* environment.c */

static inline struct mind *environment_mind(void *env)
{
    return GetEnvironmentContext(env);
}

/** Takes out of an environment what rules must not reach, and sends its output to the mind. */
void environment_install(struct mind *m);

/** Builds the globals that C code knows.  @return whether CLIPS has taken them */
bool environment_build(struct mind *m);

/** Before every call into CLIPS: its error flags are sticky (6.30), so they are cleared. */
void environment_enter(struct mind *m, enum clips_mode mode);

/** After every call.  @return whether it ended in an error */
bool environment_leave(struct mind *m);

/** Visits each module, which is the current one meanwhile. */
void environment_each_module(struct mind *m, void *self, void (*visit)(struct mind *m, void *self));

/** @return the number that a global is set to; its first value when it is set to none */
double environment_global(const struct mind *m, enum clips_global which);

/* heap.c */

/** Makes the environment of a mind; from here on, environment_mind knows whose it is. */
void heap_make(struct mind *m);

/** Gives back all memory of the environment, without a look at what stands in it. */
void heap_drop(struct mind *m);

/* budget.c */

/**
 * Begins every function of mind.h that calls into CLIPS.  A call that wants more memory than it may
 * ever have ends here a second time: CLIPS is left in the middle of what it did, and all that it
 * had is gone.
 */
#define CLIPS_BROKEN(m) (!(m)->env || setjmp((m)->shelter) != 0)

/** The answer of a broken mind, with m->lost. */
#define CLIPS_BROKEN_TEXT "the rules are gone: %s"

void budget_install(struct mind *m);

/** CLIPS is left where it is: the mind is broken, and m->lost says why.  Goes back to the shelter.
 */
_Noreturn void budget_break(struct mind *m, const char *guard);

/** Says in m->lost which call into CLIPS has not come back; in the middle of it, or of a signal. */
void budget_say(struct mind *m);

/** It does not come back: both. */
_Noreturn void budget_leave(struct mind *m, const char *guard);

/** CLIPS was given memory: it may be long at work without a turn of a loop. */
void budget_allocated(struct mind *m);
void budget_start(struct mind *m, long memory_spare);

/** Counts what C code does for a rule; BUDGET_UNITS_A_TICK are a turn of a loop.  @return false:
 * there are not so many left, and the rule is stopped */
bool budget_charge(struct mind *m, uint64_t units);

/* watchdog.c */

/** The mind calls into CLIPS. */
void watchdog_enter(struct mind *m);

/* meter.c */
void meter_install(struct mind *m);

/** An argument of the call is known: it is paid for, or becomes empty. */
void meter_take(struct mind *m, struct meter *meter, DATA_OBJECT *value);

/* clips_override.c */
void builtins_install(struct mind *m);

/* load.c */

/** Loads one form after the other; what a file extends comes first. */
mu_result load_file(struct mind *m, const char *path, struct mu_fault *fault);
mu_result load_text(struct mind *m, const char *path, const char *at, struct mu_fault *fault);

/** What was loaded begins: initial facts, first values. */
mu_result load_begin(struct mind *m, const char *path, struct mu_fault *fault);
void load_reserve(struct mind *m);
void load_install(struct mind *m);

/** Loads one construct.  @return MU_OK, or MU_FAULT_FILE with what CLIPS said */
MU_MUST_USE mu_result load_construct(struct mind *m, const char *path, struct clips_form f,
                                     struct mu_fault *fault);

/* clips_place.c */
void clips_place_reserve(struct mind *m);
void clips_place_install(struct mind *m);

/** Notes where a construct stands; path NULL: it was typed, and an earlier one is forgotten. */
void clips_place_note(struct mind *m, const char *form, const char *path, int line);

/** Adds " (FILE:LINE)" where the construct of that name is from a file. */
void clips_place_add(const struct mind *m, const char *name, struct mu_text *out);

/* step.c */
void step_install(struct mind *m);

/* complaint.c */

/** Shows what went wrong in a rule or handler, each complaint once; kind: "rule", ... */
void complaint_show(struct mind *m, const char *kind, const char *name);

/* clips_failure.c */

/** A rule has ended in an error, or was stopped: counts that, and says when it is enough. */
void clips_failure_note(struct mind *m);

void clips_failure_clear(struct mind *m);

/* clips_control.c */

/** @return whether the rule that fires next has a breakpoint */
bool lifecycle_breaks(struct mind *m);

/** @return whether rules must not go on: the next one has a breakpoint, and is not passed */
bool lifecycle_stops(struct mind *m);

/* clips_diary.c: each is nothing unless the options want a diary */

void clips_diary_install(struct mind *m);

/** What follows has this cause: kind is the line's letter; what and text may be "". */
void clips_diary_cause(struct mind *m, char kind, const char *what, const char *text);

/** Somebody's line is carried out: one form of it. */
void clips_diary_line(struct mind *m, struct clips_form form);

void clips_diary_mail(struct mind *m, const struct mind_mail *mail);

/** m->rule fires, on what CLIPS has bound. */
void clips_diary_rule(struct mind *m);

/** The speed in m->act was set. */
void clips_diary_speed(struct mind *m);

/** A mail was handed to the port. */
void clips_diary_told(struct mind *m, const struct mind_letter *letter);

/** What is left on the agenda when a step's firing has ended. */
void clips_diary_agenda(struct mind *m);

/* clips_layer.c */

/**
 * Makes a deffunction the youngest handler of a layer.
 *
 * @return MU_OK; MU_ABSENT: there is none that takes four arguments; MU_FULL
 */
MU_MUST_USE mu_result layers_add(struct mind *m, uint32_t layer, const char *function);

/** @return the deffunction of that name if it can be called as a handler, or NULL */
struct deffunctionStruct *layers_function(const struct mind *m, const char *name);

enum { LAYERS_ARGUMENTS = 4 }; /* of a handler: id, from, performative, content */

/* clips_functions.c */
void functions_install(struct mind *m);

/* clips_findall.c */
struct expr *query_parse(void *env, struct expr *top, const char *source);

#endif
