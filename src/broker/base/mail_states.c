/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a mail: what its sender was told, how it ended so far, and whether it is on disk.
 */
#include "broker/base/base.h"

/* clang-format off */
/* The letters of the tables; X is a refusal. */
enum {
    X = 255,
    N = TOLD_NOTHING, S = TOLD_STORED, L = TOLD_LAST,
    T = FATE_TAKEN, P = FATE_PASSED_ON, E = FATE_EXPIRED, D = FATE_DROPPED,
    R = DURABLE_NOT, M = DURABLE_MARKED, W = DURABLE_WRITTEN, A = DURABLE_MARKED_AGAIN
};

static const unsigned char next_told[TOLD_STATES][TOLD_EVENTS] = {
    /*               stores ends */
    [TOLD_NOTHING] = {S,    L},
    [TOLD_STORED]  = {S,    L},
    [TOLD_LAST]    = {L,    L},
};

static const unsigned char next_fate[FATES][FATE_EVENTS] = {
    /*                 passes expires drops */
    [FATE_TAKEN]     = {P,    E,      D},
    [FATE_PASSED_ON] = {P,    E,      D},
    [FATE_EXPIRED]   = {E,    E,      D},
    [FATE_DROPPED]   = {D,    D,      D},
};

static const unsigned char next_durable[DURABLE_STATES][DURABLE_EVENTS] = {
    /*                       marks commits restores undoes */
    [DURABLE_NOT]          = {M,   X,      W,       X},
    [DURABLE_MARKED]       = {M,   W,      X,       R},
    [DURABLE_WRITTEN]      = {A,   X,      X,       X},
    [DURABLE_MARKED_AGAIN] = {A,   W,      X,       X},
};
/* clang-format on */

bool mail_told_on(struct mail *m, enum mail_told_event event)
{
    enum mail_told before = m->told;
    m->told = (enum mail_told)next_told[before][event];
    return m->told != before;
}

void mail_fate_on(struct mail *m, enum mail_fate_event event)
{
    m->fate = (enum mail_fate)next_fate[m->fate][event];
}

bool mail_durable_on(struct mail *m, enum mail_durable_event event)
{
    enum mail_durable before = m->durable;
    unsigned next = next_durable[before][event];
    MU_ASSERT(next != X);
    m->durable = (enum mail_durable)next;
    return m->durable != before;
}
