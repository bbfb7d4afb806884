/* SPDX-License-Identifier: Apache-2.0 */
/* The turns of a process: how long it waits, and what it does then. */
#include "core/clock.h"
#include "core/forks.h"
#include "core/signals.h"
#include "runtime/process.h"

#include <time.h>

/* A registration is said again this often, by the wall: after a stop, only new data tells the
 * broker that its writer lives. */
static const uint64_t HEARTBEAT_NS = 300000000;

/* And so often while it speaks to its broker, which calls the roll when it has missed it. */
static const uint64_t HEARTBEAT_SPEAKING_NS = 3000000000;

/* While something has not matched yet, or the network is busy, look again this often. */
static const int64_t IMPATIENT_NS = 2000000;

/* While no broker has answered, look at the time this often.  Its answer is a sample, and wakes us.
 */
static const int64_t EXPECTANT_NS = 20000000;

/* In lock step, a process waits so long for both samples of a step at once. */
static const int64_t PAIR_NS = 50000000;

/* How long a process that ends waits for the network to take its last words. */
static const int64_t CLOSE_PATIENCE_NS = 200000000;

/* A process that goes on waits so long for an agent's last words, and no longer once it hears its
 * broker: DDS waits for a reader that was killed until the lease of that ends.  The broker refuses
 * no agent that asks for the name before that. */
static const uint64_t LEAVE_PATIENCE_NS = 500000000;

/* The white pages show handlers that run for longer. */
static const uint64_t BUSY_NS = 500000000;

/* @return whether the broker has all that was written, or DDS waits for another reader */
static bool last_words_are_out(mu_process *p)
{
    /* A broker that lives has them soon, and then no sample comes that would wake us. */
    int64_t most_ns = p->leaving_ns ? EXPECTANT_NS : CLOSE_PATIENCE_NS;
    p->leaving_ns = p->leaving_ns ? p->leaving_ns : mu_clock_ns();
    return bus_drain(&p->up, most_ns) || bus_writer_matches(&p->up) == 0 ||
           p->link.lives_ns > p->leaving_ns + LEAVE_PATIENCE_NS;
}

void process_see_out(mu_process *p, bool closes)
{
    if (!closes && (p->leaving == 0 || p->up_state == UP_PENDING)) {
        return;
    }
    if (closes) {
        (void)bus_drain(&p->up, CLOSE_PATIENCE_NS);
    } else if (!last_words_are_out(p)) {
        return;
    }
    p->leaving = 0;
    p->leaving_ns = 0;
    for (uint32_t i = 0; i < p->agent_count; i++) {
        struct mu_agent *a = &p->agents[i];
        if (life_is_leaving(a) && !closes && agent_has_last_words(a)) {
            p->leaving++;
        } else if (life_is_leaving(a)) {
            life_exit_on(a, EXIT_SAID_ALL);
            roll_mark(a);
        }
    }
    for (uint32_t i = 0; i < p->agent_count && p->leaving == 0; i++) {
        if (p->agents[i].name_state == NAME_FOLLOWS) {
            (void)life_name_on(&p->agents[i], NAME_FREE);
            roll_mark(&p->agents[i]);
        }
    }
}

/* Everything that a step needs has found its other side. */
static bool process_is_ready(const mu_process *p)
{
    return p->broker_incarnation != 0 && process_has_seen(p, -1) &&
           bus_writer_reaches(&p->up, p->link.partition) &&
           bus_writer_reaches(&p->up, "simulator") && bus_reader_matches(&p->delivery) > 0 &&
           bus_reader_matches(&p->sense) > 0;
}

/* @return whether the simulator's steps may come soon */
static bool process_awaits_steps(const mu_process *p)
{
    return p->role == PROCESS_BODY ||
           (p->role == PROCESS_WATCH && bus_reader_matches(&p->sense) > 0);
}

/* The run is over, or its simulator is gone: no step will come. */
static void run_leave(mu_process *p)
{
    (void)process_step_on(p, STEP_OVER);
    p->step = NULL;
}

static void registrations_keep(mu_process *p)
{
    bool speaks = p->now_ns - p->said_ns < HEARTBEAT_NS;
    bool due = p->now_ns - p->heartbeat_ns >= (speaks ? HEARTBEAT_SPEAKING_NS : HEARTBEAT_NS);
    if (due && process_in_lockstep(p) && bus_reader_matches(&p->sense) == 0) {
        run_leave(p);
    }
    /* In lock step nothing that is looked at here changes anything; before, every change counts. */
    if (p->steps == PROCESS_GREETED && process_is_ready(p)) {
        step_hello(p);
        (void)process_step_on(p, STEP_MATCHED);
    } else if (!due) {
        return;
    } else if (p->steps == PROCESS_READY && !process_is_ready(p)) {
        (void)process_step_on(p, STEP_UNMATCHED);
    }
    p->heartbeat_ns = p->now_ns;
    roll_refresh(p);
}

static void busy_say(mu_process *p, uint64_t busy_ns)
{
    struct tm utc;
    p->busy_since_wall_ns = mu_clock_wall_ns() - busy_ns;
    time_t since = (time_t)(p->busy_since_wall_ns / 1000000000u);
    gmtime_r(&since, &utc);
    (void)strftime(p->busy, sizeof p->busy, "busy since %Y-%m-%dT%H:%M:%SZ", &utc);
    roll_mark_all(p);
}

void process_work(mu_process *p)
{
    uint64_t now_ns = mu_clock_ns();
    if (p->works_ns == 0 || now_ns - p->works_ns < BUSY_NS) {
        return;
    }
    if (!p->busy[0]) {
        busy_say(p, now_ns - p->works_ns);
    }
    if (now_ns - p->heartbeat_ns >= HEARTBEAT_NS) {
        p->heartbeat_ns = now_ns;
        roll_refresh(p);
    }
    roll_write(p);
}

static bool handle_next(mu_process *p, uint64_t now_ns)
{
    p->works_ns = now_ns;
    bool handled = process_handle_one(p);
    p->works_ns = 0;
    if (p->busy[0]) {
        p->busy[0] = '\0';
        p->busy_since_wall_ns = 0;
        roll_mark_all(p);
    }
    return handled;
}

/* How long a process that waits need not look by itself: being ready for lock step brings no
 * sample, and has to be looked for; the broker's answer wakes us.  A crowd of processes that looked
 * before that would keep the broker from answering. */
static int64_t patience_ns(mu_process *p)
{
    if (!step_retry(p) || inbox_lacks(p)) {
        return IMPATIENT_NS;
    }
    if (!mu_process_broker(p)) {
        return EXPECTANT_NS;
    }
    bool settled =
        p->roll.due_count == 0 && (p->steps >= PROCESS_READY || !process_awaits_steps(p));
    return settled ? (int64_t)HEARTBEAT_NS : IMPATIENT_NS;
}

/* How long it may wait: until something is to be looked at, or acknowledgements are due. */
static int64_t rest_ns(mu_process *p)
{
    int64_t most_ns = patience_ns(p);
    int64_t acks_ns =
        process_in_lockstep(p) ? INT64_MAX : ack_delay_wait_ns(&p->ack_delay, p->now_ns);
    return acks_ns < most_ns ? acks_ns : most_ns;
}

static void handle_all(mu_process *p)
{
    uint64_t now_ns = p->now_ns;
    while (p->steps != PROCESS_DONE && step_retry(p) && handle_next(p, now_ns)) {
        now_ns = mu_clock_ns();
    }
}

/* --- spinning --------------------------------------------------------------------------------- */

/* While the mail of a step lies there, a probe is a second sample.  While that mail is late,
 * because another process is, the first sample may be a probe. */
static void samples_await(mu_process *p, int64_t most_ns)
{
    uint64_t wanted = process_samples_wanted(p);
    int64_t pair_ns = most_ns < PAIR_NS ? most_ns : PAIR_NS;
    if (wanted < 2) {
        (void)bus_wait(&p->bus, wanted, most_ns);
    } else if (!bus_wait(&p->bus, 2, pair_ns)) {
        (void)bus_wait(&p->bus, 1, most_ns - pair_ns);
    }
}

void process_turn(mu_process *p)
{
    handle_all(p);
    if (process_in_lockstep(p)) {
        step_say_transfers(p);
    } else {
        step_flush(p);
    }
    process_see_out(p, false);
    roll_write(p);
}

static mu_result spin(mu_process *p, int64_t timeout_ns)
{
    bool turned;
    p->now_ns = mu_clock_ns();
    MU_TRY(link_look(p, &turned));
    if (turned) {
        inbox_drop(p);
    }
    registrations_keep(p);
    roll_write(p);
    if (!process_in_lockstep(p)) {
        step_flush(p);
    }
    int64_t most_ns = rest_ns(p);
    samples_await(p, timeout_ns < most_ns ? timeout_ns : most_ns);
    p->now_ns = p->bus.waited_ns;
    process_turn(p);
    return p->steps == PROCESS_DONE ? MU_DONE : MU_OK;
}

mu_result mu_process_spin(mu_process *p, int64_t timeout_ns)
{
    if (p->spins) {
        return MU_BUSY; /* the Delivery in hand would be lost */
    }
    if (p->forks != mu_forks()) {
        return MU_FAULT_USAGE;
    }
    p->spins = true;
    mu_result spun = spin(p, timeout_ns);
    p->spins = false;
    return spun;
}

int mu_process_wake_fd(mu_process *p)
{
    return bus_wake_fd(&p->bus);
}

mu_result mu_process_await_broker(mu_process *p, uint64_t patience_ns)
{
    uint64_t began_ns = mu_clock_ns();
    while (p->broker_incarnation == 0) {
        if (mu_clock_ns() - began_ns > patience_ns) {
            return MU_TIMEOUT;
        }
        mu_result spun = mu_process_spin(p, EXPECTANT_NS);
        if (spun != MU_OK) {
            return spun;
        }
    }
    return MU_OK;
}

mu_result mu_process_run(mu_process *p)
{
    mu_signals_note();
    mu_result spun = MU_OK;
    bool ran = p->runs; /* a handler called this, and hears MU_BUSY */
    p->runs = true;
    while (spun == MU_OK && !p->stopped && !mu_signal_came) {
        spun = mu_process_spin(p, (int64_t)HEARTBEAT_NS);
        if (p->round && spun == MU_OK) {
            p->round(p->round_self);
        }
    }
    p->runs = ran;
    return spun < 0 || spun == MU_BUSY ? spun : MU_OK;
}
