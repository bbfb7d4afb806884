/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file port.h
 * CLIPS gets from a mind what it would get from the C library, and tells the mind what rules cost.
 *
 * The Makefile includes this file before each file of CLIPS that it compiles; patches/clips puts
 * the calls of meter_begin, meter_end, budget_argument and PORT_EVALUATED where they belong.
 */
#ifndef MUSTER_MIND_ENGINE_PORT_H
#define MUSTER_MIND_ENGINE_PORT_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/* Rules have no (profile), (bsave) and the like, so nothing pays for them: setup.h of CLIPS takes
 * this. */
#define PROFILING_FUNCTIONS 0
#define BLOAD_AND_BSAVE     0
#define BLOAD_INSTANCES     0
#define BSAVE_INSTANCES     0
#define CONSTRUCT_COMPILER  0

enum {
    BUDGET_TICKS_MAX = 2000000, /* turns of loops and returns of functions, for a step or a line */
    BUDGET_UNITS_A_TICK = 64,   /* a unit is about a byte that a function reads */
    BUDGET_UNITS_A_CALL = BUDGET_UNITS_A_TICK / 8,
    BUDGET_UNITS_MAX = BUDGET_TICKS_MAX * BUDGET_UNITS_A_TICK, /* CLIPS is told to come back */
    BUDGET_UNITS_LEFT = 2 * BUDGET_UNITS_MAX                   /* CLIPS is left where it is */
};

/* A call of a function that pays for its arguments. */
struct meter_row;
struct meter {
    const struct meter_row *row;
    const void *call; /* struct expr */
    uint64_t fields;  /* of the arguments so far */
    struct meter *outer;
};

/* The beginning of an environment's context, which is NULL while CLIPS makes the environment. */
struct port_cost {
    uint64_t units;      /* of work, since CLIPS was entered */
    struct meter *meter; /* of the innermost call that has one, or NULL */
};

/* heap.c.  env NULL: the environment that is being made. */
void *heap_take(void *env, size_t bytes);
void heap_give(void *env, void *block, size_t bytes);

/* meter.c */
int meter_begin(void *env, struct meter *meter, const struct meter_row *row);
void meter_end(void *env, struct meter *meter);
struct dataObject;
void meter_evaluated(void *env, struct dataObject *value);

/* budget.c */
int budget_argument(void *env, int position);

/* Evaluation of an expression ends with this. */
#define PORT_EVALUATED(env, expression, value)                                                    \
    do {                                                                                          \
        struct port_cost *cost_ = ((struct environmentData *)(env))->context;                     \
        if (cost_) {                                                                              \
            cost_->units += (expression)->type == FCALL ? BUDGET_UNITS_A_CALL : 1;                \
            if (__builtin_expect(cost_->units > BUDGET_UNITS_LEFT, 0) ||                          \
                (cost_->meter && cost_->meter->call == EvaluationData(env)->CurrentExpression)) { \
                meter_evaluated(env, value);                                                      \
            }                                                                                     \
        }                                                                                         \
    } while (0)

#ifdef PORT_MEMORY /* memalloc.c, where theEnv and size are parameters */
#define malloc(bytes) heap_take(theEnv, bytes)
#define free(block)   heap_give(theEnv, block, size)
#endif

#ifdef PORT_ENVIRONMENT /* envrnmnt.c: an environment goes with its heap */
#define malloc(bytes) heap_take(NULL, bytes)
#define free(block)   ((void)(block))
#endif

#ifdef PORT_CALLS /* the callers of rules' code: budget.c stands before each call */
#define EvaluateProcActions budget_evaluate_actions
#endif

#endif
