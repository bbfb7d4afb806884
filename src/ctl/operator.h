/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file operator.h
 * The command line as an agent: it joins as `operator`, does one thing and leaves.
 *
 * A verb that only reads joins as `operator-N`, so that many of them can look at a time; there are
 * few such names, as a broker keeps each that it has ever heard.
 */
#ifndef MUSTER_CTL_OPERATOR_H
#define MUSTER_CTL_OPERATOR_H

#include "core/network.h"
#include "core/options.h"
#include "muster/agent.h"
#include "runtime/glances.h"

/* What a verb that lives longer does with what comes, in place of the operator. */
struct operator_hooks {
    void *self;
    void (*on_mail)(void *self, const struct mu_mail *mail);
    void (*on_receipt)(void *self, uint64_t first_seq, uint64_t last_seq, enum mu_outcome outcome);
};

struct operator_options {
    struct mu_network network; /* domain < 0: the one live run's, else 0 */
    const char *as;            /* NULL: operator, or a reader's name */
    double wait_s;             /* for an answer; 0: none is wanted */
    bool json, quiet;
    bool takes_no_mail; /* what waits for the agent stays where it is */
    bool only_reads;    /* it need not be the operator; a console is the operator all the same */
    bool stays;         /* it reads for long: who does so for a moment does not take its name while
                           it is away */
    const struct operator_hooks *hooks; /* or NULL */
};

struct operator
{
    mu_process *process;
    mu_agent *agent;
    bool registered, refused;
    char reason[MU_FIELD_MAX + 1]; /* refused: why */
    bool json, quiet;
    enum mu_outcome outcome; /* of the last mail sent: the last word so far */
    uint64_t seq;            /* its number */
    bool answered_for;       /* there is an outcome */
    bool asks_many;          /* nobody in particular: not-understood is no answer */
    unsigned answers;        /* mails that came in reply to it */
    int failure_code;        /* the smallest exit code of those that are failures; 0: none is */
    const char *reply_with;  /* that answers refer to; NULL: none are wanted */
    char reply_with_own[32];
    uint64_t glance;        /* number of the question that was asked; 0: none waits */
    enum glance_end looked; /* what came of it */
    const struct operator_hooks *hooks;
    /* Takes an answer instead of its being printed; may be NULL. */
    void (*on_answer)(void *self, const struct mu_mail *mail);
    void *on_answer_self;
};

/* Rows of an options table that every such verb has. */
#define OPERATOR_OPTIONS(options)       \
    MU_JOIN_OPTIONS((options).network), \
        MU_STRING("as", "NAME", (options).as, "act as another agent than the operator")

/** Reads the options of a verb; its words stay in o.  @return MU_OK, MU_DONE or a fault */
MU_MUST_USE mu_result operator_parse(struct mu_options *o, int argc, char **argv,
                                     struct operator_options *options);

/**
 * Joins and waits for the broker's word and all of its pages.  A name that another verb holds is
 * waited for.
 *
 * @return MU_EXIT_DONE, or the exit code, explained
 */
int operator_join(struct operator* o, const struct operator_options *options, const char *verb);

/**
 * Sends one mail, waits for its receipt and, if answers_wanted > 0, for so many answers, which are
 * printed on standard output, unless on_answer takes them.
 *
 * @param mail  reply_with: "" or NULL: one is made up if answers are wanted
 * @return the exit code
 */
int operator_send(struct operator* o, struct mu_mail *mail, unsigned answers_wanted, double wait_s);

/**
 * Asks one agent for a line that only looks, and prints the answer as that of a directive.
 *
 * @return the exit code; < 0: it is no such line, or was declined, and nothing was printed
 */
int operator_look(struct operator* o, const char *agent, const char *line, double wait_s);

/** @return the line of one who was written to in person, and is busy; NULL: that is not why */
const struct mu_member *operator_busy(const struct operator* o, const char *to);

/** Prints what became of a mail as an object.  @param code  exit code; < 0: it is left out */
void operator_outcome_print(const char *to, uint64_t seq, const char *outcome, int code);

void operator_leave(struct operator* o);

#endif
