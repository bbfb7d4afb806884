/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/runclock.h"

void runclock_set_now(struct runclock *c, uint64_t now_ns)
{
    if (now_ns > c->now_ns) {
        c->now_ns = now_ns;
    }
}

void runclock_start(struct runclock *c, bool lockstep, uint64_t run_ns)
{
    uint64_t mail_ns = runclock_mail_ns(c);
    c->runs = true;
    c->lockstep = lockstep;
    c->run_ns = run_ns;
    c->base_ns = c->now_ns;
    c->mail_lead_ns = mail_ns - (lockstep ? run_ns : c->now_ns);
}

void runclock_step(struct runclock *c, uint64_t run_ns)
{
    c->run_ns = run_ns;
}

uint64_t runclock_run_ns(const struct runclock *c)
{
    if (!c->runs || c->lockstep) {
        return c->run_ns;
    }
    return c->run_ns + (c->now_ns - c->base_ns);
}

uint64_t runclock_mail_ns(const struct runclock *c)
{
    return (c->lockstep ? c->run_ns : c->now_ns) + c->mail_lead_ns;
}

uint64_t runclock_now_of_mail_ns(const struct runclock *c, uint64_t mail_ns)
{
    uint64_t ahead_ns = mail_ns - runclock_mail_ns(c);
    return ahead_ns > UINT64_MAX - c->now_ns ? UINT64_MAX : c->now_ns + ahead_ns;
}

uint64_t runclock_now_of_run_ns(const struct runclock *c, uint64_t run_ns)
{
    uint64_t ahead_ns = run_ns - runclock_run_ns(c);
    return ahead_ns > UINT64_MAX - c->now_ns ? UINT64_MAX : c->now_ns + ahead_ns;
}
