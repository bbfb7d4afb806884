/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a process: of its reader and its writer. */
#include "broker/names/names.h"

/* clang-format off */
/* The letters of the tables; X is illegal. */
enum {
    X = 255,
    F = SESSION_FREE, A = SESSION_AWAY, T = SESSION_THERE, H = SESSION_HEARS,
    B = SESSION_AWAY_SILENT, U = SESSION_THERE_SILENT, I = SESSION_HEARS_SILENT
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
/* clang-format on */

enum session processes_next_session(enum session session, enum session_event event)
{
    unsigned next = next_session[session][event];
    return next == X ? SESSIONS : (enum session)next;
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
