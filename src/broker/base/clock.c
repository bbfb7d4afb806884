/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

void clock_start(struct clock *c, uint64_t step_ns, uint64_t run_ns)
{
    uint64_t mail_ns = clock_mail_ns(c);
    c->runs = true;
    c->mode = step_ns > 0 ? CLOCK_COLLECTS : CLOCK_WALL;
    c->step_ns = step_ns;
    c->run_ns = run_ns;
    c->base_ns = c->now_ns;
    c->mail_lead_ns = mail_ns - (step_ns > 0 ? run_ns : c->now_ns);
}

uint64_t clock_then_ns(const struct clock *c, uint64_t shows_ns, uint64_t then_ns)
{
    uint64_t ahead_ns = then_ns > shows_ns ? then_ns - shows_ns : 0;
    return clock_after_ns(c->now_ns, ahead_ns);
}

uint64_t clock_stamp_ns(const struct clock *c)
{
    return clock_by_steps(c) ? clock_run_ns(c) : clock_wall_ns(c);
}
