/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a process: of its reader and its writer, and of its turn to be served. */
#include "broker/names/names.h"

/* clang-format off */
/* The letters of the tables; X is illegal. */
enum {
    X = 255,
    F = SESSION_FREE, A = SESSION_AWAY, T = SESSION_THERE, H = SESSION_HEARS,
    B = SESSION_AWAY_SILENT, U = SESSION_THERE_SILENT, I = SESSION_HEARS_SILENT,
    D = TURN_IDLE, R = TURN_READY, W = TURN_HELD, V = TURN_HELD_READY, N = TURN_REFUSED,
    M = TURN_REFUSED_READY
};

static const unsigned char next_session[SESSIONS][SESSION_EVENTS] = {
    /*                        enters matched unmatched multicasts heard silent forgotten */
    [SESSION_FREE]         = {A,     X,      X,        X,         X,    X,     X},
    [SESSION_AWAY]         = {X,     T,      A,        X,         A,    B,     F},
    [SESSION_THERE]        = {X,     T,      A,        H,         T,    U,     X},
    [SESSION_HEARS]        = {X,     T,      A,        H,         H,    I,     X},
    [SESSION_AWAY_SILENT]  = {X,     U,      B,        X,         A,    B,     F},
    [SESSION_THERE_SILENT] = {X,     U,      B,        I,         T,    U,     X},
    [SESSION_HEARS_SILENT] = {X,     U,      B,        I,         H,    I,     X},
};

static const unsigned char next_turn[TURNS][TURN_EVENTS] = {
    /*                      wakes looked at held round refused retried forgotten */
    [TURN_IDLE]          = {R,    X,        W,   D,    N,      D,      D},
    [TURN_READY]         = {R,    D,        X,   R,    M,      R,      R},
    [TURN_HELD]          = {V,    X,        W,   D,    N,      W,      D},
    [TURN_HELD_READY]    = {V,    W,        X,   R,    M,      V,      R},
    [TURN_REFUSED]       = {M,    X,        X,   N,    N,      D,      D},
    [TURN_REFUSED_READY] = {M,    N,        X,   M,    M,      R,      R},
};
/* clang-format on */

enum session processes_next_session(enum session session, enum session_event event)
{
    unsigned next = next_session[session][event];
    return next == X ? SESSIONS : (enum session)next;
}

enum turn_state processes_next_turn(enum turn_state turn, enum turn_event event)
{
    unsigned next = next_turn[turn][event];
    return next == X ? TURNS : (enum turn_state)next;
}

bool processes_is_matched(const struct process *at)
{
    static const bool matched[SESSIONS] = {[SESSION_THERE] = true,
                                           [SESSION_HEARS] = true,
                                           [SESSION_THERE_SILENT] = true,
                                           [SESSION_HEARS_SILENT] = true};
    return matched[at->session];
}

bool processes_hears(const struct process *at)
{
    return at->session == SESSION_HEARS || at->session == SESSION_HEARS_SILENT;
}

bool processes_is_silent(const struct process *at)
{
    static const bool silent[SESSIONS] = {
        [SESSION_AWAY_SILENT] = true, [SESSION_THERE_SILENT] = true, [SESSION_HEARS_SILENT] = true};
    return silent[at->session];
}

bool processes_is_held(const struct process *at)
{
    return at->turn == TURN_HELD || at->turn == TURN_HELD_READY;
}

bool processes_is_refused(const struct process *at)
{
    return at->turn == TURN_REFUSED || at->turn == TURN_REFUSED_READY;
}
