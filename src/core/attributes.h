/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file attributes.h
 * Attributes of a service, and queries on them: the one matcher of broker and runtime.
 *
 * Attributes are words key=value, each key once: "role=scout battery=0.8 x=2.5 y=-1".
 *
 * A query is a service, or * for any, and then constraints that must all hold:
 *
 *     mapper role=scout battery>=0.5 y!=2     = != < <= > >=
 *     * near=2.5,-1,3                         x and y, in metres, at most 3 m from (2.5, -1)
 *
 * Two numbers are compared as numbers, all other values as text, which has no order.  A constraint,
 * also one with !=, never holds for a key that the service lacks.
 */
#ifndef MUSTER_CORE_ATTRIBUTES_H
#define MUSTER_CORE_ATTRIBUTES_H

#include "muster/limits.h"
#include "muster/result.h"

#include <stdbool.h>

enum mu_relation {
    MU_RELATION_EQUAL,
    MU_RELATION_UNEQUAL,
    MU_RELATION_LESS,
    MU_RELATION_AT_MOST,
    MU_RELATION_MORE,
    MU_RELATION_AT_LEAST,
    MU_RELATION_NEAR,
};

struct mu_constraint {
    char key[MU_NAME_MAX + 1];
    enum mu_relation relation;
    char value[MU_FIELD_MAX + 1];
    bool is_number; /* value is: */
    double number;
    double x_m, y_m, radius_m; /* of near */
};

struct mu_query {
    char service[MU_NAME_MAX + 1]; /* "*": any */
    unsigned count;
    struct mu_constraint constraints[MU_CONSTRAINTS_MAX];
};

/** @return whether the text is nothing but attributes, and at most MU_ATTRIBUTES_MAX long */
bool mu_attributes_valid(const char *text);

/** Reads a query.  @return MU_OK; MU_MALFORMED; MU_FULL: more than MU_CONSTRAINTS_MAX of them */
MU_MUST_USE mu_result mu_attributes_query(struct mu_query *q, const char *text);

/** @return whether a service with these (valid) attributes fits */
bool mu_attributes_match(const struct mu_query *q, const char *service, const char *attributes);

#endif
