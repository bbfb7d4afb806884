/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The last resort, outside of the engine: a call into it has run for seconds and has hardly come to
 * a check of its budget.  The owner's timer brings the time.
 */
#include "mind/mind.h"
#include "mind/snapshot/snapshot.h"

enum {
    WATCHDOG_UNITS = 1000 * BUDGET_UNITS_A_TICK
}; /* an engine at work counts a thousand times as much between two looks */

static struct {
    uint64_t looked_at, seen; /* calls into engines, and units counted, at the last look */
    unsigned hanging_ms;      /* since an engine came to a check of its budget */
} watchdog;

static bool watchdog_hangs(const struct mind *m, uint64_t entries, unsigned ms)
{
    bool hangs = watchdog.looked_at == entries && m->cost.units - watchdog.seen < WATCHDOG_UNITS;
    watchdog.hanging_ms = hangs ? watchdog.hanging_ms + ms : 0;
    watchdog.looked_at = entries;
    watchdog.seen = m->cost.units;
    return hangs;
}

int mind_look(unsigned ms, struct mu_text *why)
{
    uint64_t entries;
    struct mind *m = environment_entered(&entries);
    if (!m || !state_is_limited(m) || !m->options.ports.stuck || !watchdog_hangs(m, entries, ms)) {
        return MIND_WAITS;
    }
    int code = m->options.ports.stuck(m->options.ports.self, watchdog.hanging_ms);
    if (code == MIND_BREAKS) {
        watchdog.hanging_ms = 0;
        budget_leave(m, "time");
    } else if (code != MIND_WAITS) {
        budget_say(m);
        mu_text_format(why, "%s: %s\n", m->name, m->lost);
    }
    return code;
}
