/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file engine.h
 * CLIPS as the engine of a mind: its environment, its memory, what stops it, what it prints; and
 * its values, which the functions that rules call take and give.
 */
#ifndef MUSTER_MIND_ENGINE_H
#define MUSTER_MIND_ENGINE_H

#include "core/fault.h"
#include "core/text.h"
#include "mind/engine/port.h"
#include "mind/interface/interface.h"
#include "mind/syntax/syntax.h"

#include <clips.h>
#include <limits.h>
#include <setjmp.h>
#include <tmpltutl.h>

enum {
    BUDGET_DEPTH_MAX = 1000,           /* functions that have not returned */
    BUDGET_STACK_MAX = 3 << 20,        /* bytes of stack below the entry */
    BUDGET_MEMORY_MAX = 64 << 20,      /* bytes that CLIPS holds */
    BUDGET_MEMORY_BURST = 384 << 20,   /* more is not given to it, even in the middle of one call */
    FAILURES_MAX = 64,                 /* different rules whose failures are counted */
    BUDGET_MEMORY_SPARE = 8 << 20,     /* more of them for a line, so that a person can tidy up */
    ENVIRONMENT_PRINT_MAX = 64 * 1024, /* bytes that one step may print */
    ENVIRONMENT_LINE_MAX = 16384,      /* bytes of a console line */
    ENVIRONMENT_SAID_MAX = 2048,       /* bytes kept of an error */
    STEP_FIRED_MAX = 8192,             /* bytes of names of the rules fired in a step */
    COMPLAINT_SHOWN_MAX = 64,          /* different errors of rules that were shown */
    TRACE_MAX = 16384,                 /* bytes of what went on in a step, for recordings */
    TRACE_AGENDA = 32,                 /* activations in it */
    TRACE_LINE = 1024,                 /* bytes of a person's line in it */
};

/* Where the text that CLIPS prints goes: errors to m->said, the rest likewise, to the port, or to
 * the answer of a line with the errors. */
enum state_mode { STATE_MODE_QUIET, STATE_MODE_FIRE, STATE_MODE_LINE };

/* A mind does one thing at a time with its CLIPS. */
enum mind_state {
    MIND_VACANT,   /* it has no environment */
    MIND_LOADING,  /* rules, or a snapshot */
    MIND_READY,    /* between two calls */
    MIND_SENSING,  /* a percept, an event or a fact */
    MIND_TAKING,   /* mail */
    MIND_FIRING,   /* rules */
    MIND_HANDLING, /* mail or a question, by a deffunction */
    MIND_LINE,     /* a line that was typed */
    MIND_LOOKING,  /* a line that only looks */
    MIND_SAVING,
    MIND_FAILED, /* out of memory or time: its environment is gone */
    MIND_STATES
};

enum state_event {
    STATE_BEGIN,
    STATE_LOAD,
    STATE_SENSE,
    STATE_TAKE,
    STATE_FIRE,
    STATE_HANDLE,
    STATE_LINE,
    STATE_LOOK,
    STATE_SAVE,
    STATE_DONE,
    STATE_FAIL,
    STATE_CLOSE,
    STATE_EVENTS
};

enum state_outcome { STATE_ILLEGAL, STATE_REFUSED, STATE_MOVES };

/* How often a rule has failed. */
struct failures_line {
    char rule[MU_FIELD_MAX + 1]; /* its name, or how that begins */
    uint32_t count;
};

struct source_lines; /* source_lines.c */

enum {
    HEAP_SIZES = 24, /* sizes of small blocks: 8, 16, ... bytes */
    HEAP_PARTS = 20, /* of larger ones: a page, or a half of it, or a third, ... */
    HEAP_KNOWN = 256 /* pages that have numbers, for prefetch.c: 0 to 255 */
};

/* The memory of an environment: heap.c. */
struct heap {
    struct heap_item *large, *full,
        *pages[HEAP_SIZES + HEAP_PARTS]; /* with room, by kind of block */
    size_t held;                         /* bytes in all blocks */
    char *known[HEAP_KNOWN];             /* pages by number; NULL: it was given back */
    uint32_t numbers, spares;            /* that were used so far; of them, those that are free: */
    uint16_t spare[HEAP_KNOWN];
    uint64_t shape; /* a hash of the sizes of blocks in the pages that were opened */
};

/* Globals that C code reads; environment.c has their names and first values. */
enum environment_number {
    ENVIRONMENT_SONAR_MARGIN,
    ENVIRONMENT_SONAR_CLIP,
    ENVIRONMENT_FOLLOW_DISTANCE,
    ENVIRONMENT_CARE,
    ENVIRONMENT_NUMBERS
};

/* How the trace takes a fact that is asserted now. */
enum trace_fact {
    TRACE_CAUSED, /* of the cause above it */
    TRACE_SENSED, /* of this step's percept */
    TRACE_SHOWN   /* of an earlier percept, asserted now because a person looks */
};

/*
 * A mind as its engine sees it.  It is the beginning of what each floor above has of a mind; only
 * that floor and the floors above it know the rest.
 */
struct mind {
    struct port_cost cost;  /* first: port.h */
    enum mind_state state;  /* state_on alone changes it */
    uint64_t refused_calls; /* of a mind without rules */
    void *env;
    struct heap heap;
    struct prefetch *prefetch; /* prefetch.c; NULL: none */
    bool stepped;              /* its first step has begun */
    struct mind_options options;
    char name[MU_NAME_MAX + 1], folder[PATH_MAX], file[PATH_MAX]; /* that the options point to */
    struct defglobal *globals[ENVIRONMENT_NUMBERS];
    struct defmodule *module;          /* the current one, while others are for a while */
    DATA_OBJECT kept[2];               /* values of ?*my-name* and ?*mate* while (reset) runs */
    struct source_lines *source_lines; /* of what was loaded */

    /* what fires */
    char fired_bytes[STEP_FIRED_MAX];
    struct mu_text fired;
    const char *rule; /* that fired last */

    /* budget */
    uint64_t worked; /* units of the cost, when the port was told last */
    long memory_max;
    const char *stopped;   /* by which part of the budget, or NULL */
    const char *stack;     /* at the entry */
    jmp_buf shelter;       /* in the function of mind.h that entered CLIPS */
    uint32_t allocations;  /* so far */
    const char *failed_by; /* the same, if its state is MIND_FAILED */
    char lost[224];        /* why, in words */
    struct failures_line failing[FAILURES_MAX];
    size_t failing_count;
    uint64_t stops; /* by the budget */
    char reason[MU_ATTRIBUTES_MAX + 1];
    bool enough; /* for that reason; since a step was told last */

    /* output */
    struct mu_text *out; /* of a line */
    size_t printed;
    char said_bytes[ENVIRONMENT_SAID_MAX];
    struct mu_text said; /* errors and warnings of this call */
    uint64_t shown[COMPLAINT_SHOWN_MAX];
    size_t shown_count;

    /* for recordings */
    char trace_bytes[TRACE_MAX];
    struct mu_text trace;
    uint32_t trace_lost; /* lines for which there was no room */
    enum trace_fact trace_fact;
};

/** Tells the port that rules or a line have been at work for a while. */
static inline void engine_work(const struct mind *m)
{
    if (m->options.ports.work) {
        m->options.ports.work(m->options.ports.self);
    }
}

/* state.c */

/** Applies an event; an illegal one aborts.  @return false: it was refused, and counted */
bool state_on(struct mind *m, enum state_event event);

/** @return where the text that CLIPS prints goes now */
enum state_mode state_mode(const struct mind *m);

/** @return whether CLIPS is left, and the mind fails, when a call exceeds its budget */
bool state_is_limited(const struct mind *m);

/** @return whether it has an environment */
bool state_has_rules(const struct mind *m);

/** @return bytes of memory that it may take beside those that it has */
long state_spare(const struct mind *m);

/* environment.c */

static inline struct mind *environment_mind(void *env)
{
    return GetEnvironmentContext(env);
}

/** Removes functions that rules must not call, and sends the output of CLIPS to the mind. */
void environment_install(struct mind *m);

/** Builds the globals that C code knows.  @return whether CLIPS has taken them */
bool environment_build(struct mind *m);

/** Clears the error flags of CLIPS, which 6.30 keeps set, before each thing that is done with it.
 */
void environment_begin(struct mind *m);

/** Clears them again.  @return whether one was set */
bool environment_end(struct mind *m);

/**
 * Begins each function of mind.h that calls into CLIPS.  If that call exceeds the limit of memory,
 * it comes back to this place a second time: CLIPS was left where it was, and its memory is gone.
 *
 * @return false: the mind has no rules, or has lost them just now
 */
#define MIND_ENTER(m, event) (mind_enter(m, event) && setjmp((m)->shelter) == 0)
bool mind_enter(struct mind *m, enum state_event event);

/** Ends it.  @return whether CLIPS has an error flag set */
bool mind_leave(struct mind *m);

/** @return the mind of this process that used CLIPS last; entries: how often any mind has */
struct mind *environment_entered(uint64_t *entries);

/**
 * Makes the module behind another one the current one, to the end: past the last it is the one
 * again that was before the first.
 *
 * @param before  NULL: the first is wanted
 * @return the module; NULL past the last
 */
struct defmodule *environment_next_module(struct mind *m, struct defmodule *before);

/** @return the number that a global is set to; its first value when it is set to none */
double environment_global(const struct mind *m, enum environment_number which);

/* pages.c */

enum { PAGE_BYTES = 4096 }; /* a page stands at a multiple of its size */

/** @return a page; NULL: there is no memory for it */
void *pages_take(void);
void pages_give(void *page);

/** @return chunks of 2 MiB that all minds have */
uint32_t pages_chunks(void);

/* heap.c */

/** Makes the environment of a mind; environment_mind finds the mind from then on. */
void heap_make(struct mind *m);

/** Gives back all memory of the environment, whatever its contents. */
void heap_drop(struct mind *m);

/* prefetch.c */

/** Asks for the memory that a step uses, when it begins.  @return how many lines of the cache */
uint32_t prefetch_begin(struct mind *m);

/** The step has ended. */
void prefetch_end(const struct mind *m);

/** The environment of the mind goes. */
void prefetch_forget(struct mind *m);

/* budget.c */

/** The answer of a mind that has failed, with m->lost. */
#define CLIPS_BROKEN_TEXT "the rules are gone: %s"

void budget_install(struct mind *m);

/** Writes into m->lost which call has not returned; also from within it, or a signal handler. */
void budget_say(struct mind *m);

/** Says which call has not returned, and leaves it. */
_Noreturn void budget_leave(struct mind *m, const char *why);

/** Gives a new budget of ticks.  @param memory_spare  bytes beside those that CLIPS has */
void budget_start(struct mind *m, long memory_spare);

/** Counts the work of C code for a rule.  @return false: fewer units are left; the rule stops */
bool budget_charge(struct mind *m, uint64_t units);

/* meter.c */
void meter_install(struct mind *m);

/* source_lines.c */
void source_lines_reserve(struct mind *m);
void source_lines_install(struct mind *m);

/** Notes where a construct stands.  A typed one, path NULL, takes the place of an earlier one. */
void source_lines_note(struct mind *m, const char *form, const char *path, int line);

/** Adds " (FILE:LINE)" where the construct of that name is from a file. */
void source_lines_add(const struct mind *m, const char *name, struct mu_text *out);

/* complaint.c */

/** Prints the errors of a rule or a handler, each complaint once.  @param kind  "rule", ... */
void complaint_show(struct mind *m, const char *kind, const char *name);

/* failures.c */

/** Counts a failure of m->rule; m->enough says that it has failed too often. */
void failures_note(struct mind *m);

void failures_clear(struct mind *m);

/* trace.c: these functions do nothing unless the options want a trace */

void trace_install(struct mind *m);

/** Begins a cause, of which the lines that follow are effects.  @param kind  the line's letter */
void trace_cause(struct mind *m, char kind, const char *what, const char *text);

/** Notes one form of a line that was typed. */
void trace_line(struct mind *m, struct syntax_form form);

void trace_mail(struct mind *m, const struct mind_mail *mail);

/** Notes that m->rule fires, and its matches. */
void trace_rule(struct mind *m);

/** Notes a new speed. */
void trace_speed(struct mind *m, double forward_m_s, double turn_rad_s);

/** Notes a mail that the port has taken. */
void trace_told(struct mind *m, const struct mind_letter *letter);

/** Notes the agenda that is left when a step's firing has ended. */
void trace_agenda(struct mind *m);

/* value.c */

/** Ends the call in a CLIPS error: "Function NAME expected WANTED". */
void value_refuse(void *env, const char *function, const char *wanted);

void value_bool(void *env, DATA_OBJECT *out, bool value);
void value_float(void *env, DATA_OBJECT *out, double value);
void value_integer(void *env, DATA_OBJECT *out, long long value);
void value_symbol(void *env, DATA_OBJECT *out, const char *value);
void value_multifield(DATA_OBJECT *out, struct multifield *fields);
void value_floats(void *env, DATA_OBJECT *out, size_t count, const double *values);
void value_set_float(void *env, struct multifield *fields, size_t index, double value);
void value_set_symbol(void *env, struct multifield *fields, size_t index, const char *value);

/** A symbol, or the empty string. */
void value_set_word(void *env, struct multifield *fields, size_t index, const char *value);

/** Evaluates an argument; counted from 1. @return false: it ended in an error */
bool value_any(void *env, int index, DATA_OBJECT *out);

/** Evaluates an argument that must be a number; else a CLIPS error. */
bool value_number(void *env, const char *function, int index, double *out);

/** As value_number, for the first count arguments. */
bool value_numbers(void *env, const char *function, int count, double *out);

/** Evaluates an argument that must be a whole number. */
bool value_whole(void *env, const char *function, int index, long long *out);

/** Evaluates an argument that must be a symbol or a string. */
bool value_word(void *env, const char *function, int index, const char **out);

/** Adds what a pattern has matched: 12, a fact's index; [ball], an instance; *, nothing is there.
 */
void value_add_match(struct mu_text *out, const struct alphaMatch *match);

/** @return the number that a field is; 0 when it is none */
double value_of(unsigned short type, const void *value);

/** Degrees of a radian. */
#define VALUE_DEG (180 / 3.14159265358979323846)

/** @return the same angle in (-180, 180] */
double value_norm_deg(double angle_deg);

#endif
