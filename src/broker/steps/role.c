/* SPDX-License-Identifier: Apache-2.0 */
/* What a process is to a run that goes by steps. */
#include "broker/steps/steps.h"

/* clang-format off */
/* The letters of the table; X is illegal. */
enum {
    X = 255,
    O = ROLE_OUTSIDE, S = ROLE_SIMULATOR, P = ROLE_SIMULATOR_OWED, A = ROLE_AWAITED,
    B = ROLE_AWAITED_OWED, Y = ROLE_ANSWERED, Z = ROLE_ANSWERED_OWED
};

static const unsigned char next_role[ROLES][ROLE_EVENTS] = {
    /*                        joins simulates answers step ends is owed is told leaves */
    [ROLE_OUTSIDE]         = {A,    S,        X,      X,        O,      X,      X},
    [ROLE_SIMULATOR]       = {X,    X,        X,      X,        P,      X,      O},
    [ROLE_SIMULATOR_OWED]  = {X,    X,        X,      X,        P,      S,      O},
    [ROLE_AWAITED]         = {X,    X,        Y,      A,        B,      X,      O},
    [ROLE_AWAITED_OWED]    = {X,    X,        Z,      B,        B,      A,      O},
    [ROLE_ANSWERED]        = {X,    X,        X,      A,        Z,      X,      O},
    [ROLE_ANSWERED_OWED]   = {X,    X,        X,      B,        Z,      Y,      O},
};
/* clang-format on */

enum role role_next(enum role role, enum role_event event)
{
    unsigned next = next_role[role][event];
    return next == X ? ROLES : (enum role)next;
}
