/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file functions.h
 * The functions that rules may call: docs/reference/functions.md has them all.
 */
#ifndef MUSTER_MIND_FUNCTIONS_H
#define MUSTER_MIND_FUNCTIONS_H

#include "core/random.h"
#include "mind/facts/facts.h"

enum {
    LAYERS_HANDLERS_MAX = 32, /* handlers in all layers together */
};

/* A deffunction that is the handler of a layer. */
struct layers_handler {
    uint32_t layer;
    SYMBOL_HN *function;
};

/* A mind and all that its rules ordered by calls of functions. */
struct mind_output {
    struct mind_inputs inputs; /* first */
    struct mind_act act;       /* of this step */
    bool sense_again;
    struct mind_travel travel;
    struct mu_random random;
    uint64_t asked;   /* questions so far: each reply-with has another number */
    bool rules_speak; /* a construct outside of the library sends mail, or may */

    struct layers_handler handlers[LAYERS_HANDLERS_MAX]; /* the youngest last */
    size_t handler_count;
    const struct mind_mail *handled; /* the mail of the handler that runs, or NULL */

    char scheme[MU_NAME_MAX + 1]; /* of the addresses that the agent resolves; "": none */
    SYMBOL_HN *resolver;          /* the deffunction that does; NULL: none */

    /* the agent's own life */
    enum mind_wish wish;
    uint32_t wish_rules;
    char stands[MU_FIELD_MAX + 1]; /* the rule with a breakpoint before which it stopped last */
    bool passes;                   /* this rule may fire once nevertheless */
};

static inline struct mind_output *output_of(const struct mind *m)
{
    return (struct mind_output *)(uintptr_t)m;
}

/** Makes the functions known to CLIPS. */
void functions_install(struct mind *m);

/** Writes the table of them, as Markdown. */
void functions_page(struct mu_text *out);

/* builtins.c */

/** Puts functions of ours in the place of some of CLIPS's. */
void builtins_install(struct mind *m);

/* layers.c */

/**
 * Makes a deffunction the youngest handler of a layer.
 *
 * @return MU_OK; MU_ABSENT: there is none that takes four arguments; MU_FULL
 */
MU_MUST_USE mu_result layers_add(struct mind *m, uint32_t layer, const char *function);

/** @return the deffunction of that name if it can be called as a handler, or NULL */
struct deffunctionStruct *layers_function(const struct mind *m, const char *name);

/**
 * Makes a deffunction the one that resolves addresses of a scheme, in place of an earlier one.
 *
 * @return MU_OK; MU_ABSENT: there is none that takes two arguments; MU_MALFORMED: no scheme
 */
MU_MUST_USE mu_result layers_set_resolver(struct mind *m, const char *scheme, const char *function);

/** Does so, and offers it.  @return likewise; MU_FULL: no room for the offer */
MU_MUST_USE mu_result layers_resolve(struct mind *m, const char *scheme, const char *function);

/** @return the deffunction that resolves addresses if it can be called, or NULL */
struct deffunctionStruct *layers_resolver(const struct mind *m);

enum {
    LAYERS_ARGUMENTS = 4,   /* of a handler: id, from, performative, content */
    RESOLVER_ARGUMENTS = 2, /* of a resolver: rest, sender */
};

/* lifecycle.c */

/** @return whether the rule that fires next has a breakpoint */
bool lifecycle_breaks(struct mind *m);

/** @return whether rules must not go on: the next one has a breakpoint, and is not passed */
bool lifecycle_stops(struct mind *m);

/* send.c */

/** Adds a field as it reads back.  @return false: an address or a number that is not finite */
bool send_field(struct mu_text *out, unsigned short type, const void *value);

/** Adds a field, or all of a multifield.  @return false, after a CLIPS error: cannot be mailed */
bool send_content(void *env, const char *function, const DATA_OBJECT *fields, struct mu_text *out);

#endif
