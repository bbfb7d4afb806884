/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/process.h"

#include "core/clock.h"
#include "core/signals.h"
#include "muster/kind.h"
#include "muster/memory.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* A registration is said again this often, by the wall: after a stop, only new data tells the
 * broker that its writer lives. */
static const uint64_t HEARTBEAT_NS = 300000000;

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

/* A look that is due may be so much late if that saves a wake. */
static const uint64_t LATE_NS = 1000000;

/* The white pages show handlers that run for longer. */
static const uint64_t BUSY_NS = 500000000;

static mu_result endpoints_open(mu_process *p, const char *broker)
{
    MU_TRY(link_open(p, broker));
    MU_TRY(bus_writer_open(&p->bus, BUS_REGISTRATION, NULL, NULL, &p->registration));
    MU_TRY(bus_reader_open(&p->bus, BUS_DELIVERY, p->name, &p->delivery));
    MU_TRY(bus_reader_open_deep(&p->bus, BUS_DELIVERY, BUS_TO_ALL, INBOX_DEPTH, &p->multicasts));
    inbox_init(&p->inbox);
    if (process_takes_steps(p)) {
        MU_TRY(bus_reader_open(&p->bus, BUS_SENSE, p->name, &p->sense));
        p->step_kept = bus_sample(BUS_SENSE);
    }
    return MU_OK;
}

void process_take_memory(mu_process *p, uint32_t agents, uint32_t outbox_mails)
{
    p->agents_max = agents ? agents : MU_LOCAL_AGENTS;
    p->outbox_mails = outbox_mails ? outbox_mails : MU_OUTBOX_MAX;
    uint32_t acts = p->agents_max > PROCESS_UP_MAILS ? p->agents_max : PROCESS_UP_MAILS;
    p->agents = mu_startup_array(p->agents_max, sizeof *p->agents);
    p->outbox_slots =
        mu_startup_array((size_t)p->agents_max * p->outbox_mails, sizeof *p->outbox_slots);
    p->outbox_text = mu_startup_array(p->agents_max, outbox_text_bytes(p->outbox_mails));
    p->rules_text =
        p->role == PROCESS_BODY ? mu_startup_array(p->agents_max, PROCESS_RULES_MAX + 1) : NULL;
    p->note_text =
        p->role == PROCESS_BODY ? mu_startup_array(p->agents_max, MU_NOTE_MAX + 1) : NULL;
    p->bodies =
        p->role == PROCESS_WATCH ? mu_startup_array(MU_ROBOTS_MAX, sizeof *p->bodies) : NULL;
    p->dedup = mu_startup_array(p->agents_max, sizeof *p->dedup);
    p->acts = mu_startup_array(acts, sizeof *p->acts);
    /* An agent has the same room in a step, however many others share its process. */
    p->mails_max = process_takes_steps(p) ? p->agents_max * PROCESS_UP_MAILS : PROCESS_UP_MAILS;
    p->mails = mu_startup_array(p->mails_max, sizeof *p->mails);
    p->acks_max = p->agents_max > PROCESS_UP_ACKS ? p->agents_max : PROCESS_UP_ACKS;
    p->acks = mu_startup_array(p->acks_max, sizeof *p->acks);
    p->out_ackers = mu_startup_array(p->acks_max, sizeof(struct mu_agent *));
    p->out_agents = mu_startup_array(acts, sizeof(struct mu_agent *));
    mu_table_init(&p->names, p->agents_max);
    members_init(&p->members);
    p->base_kind = &mu_base_kind;
}

static bool options_fit(const struct mu_process_options *options)
{
    return options->agents <= MU_LOCAL_AGENTS_MAX && options->outbox <= MU_OUTBOX_MOST &&
           options->with_body + options->watches + options->brief <= 1;
}

/* @return as mu_process_open; what it opened and cannot use is closed again */
static mu_result bus_enter(mu_process *p, const struct mu_process_options *options)
{
    struct bus_options bus = {.domain = options->domain,
                              .place = BUS_AGENT,
                              .name = options->name ? options->name : program_invocation_short_name,
                              .interface = options->interface,
                              .hub = options->peer};
    MU_TRY(bus_open(&p->bus, &bus));
    mu_result opened = endpoints_open(p, options->broker);
    if (opened != MU_OK) {
        bus_close(&p->bus);
    }
    return opened;
}

mu_result mu_process_open(mu_process **out, const struct mu_process_options *options)
{
    static const struct mu_process_options usual;
    options = options ? options : &usual;
    if (!options_fit(options)) {
        return MU_FAULT_USAGE;
    }
    mu_process *p = mu_startup_alloc(sizeof *p);
    p->role = options->with_body ? PROCESS_BODY
              : options->watches ? PROCESS_WATCH
              : options->brief   ? PROCESS_BRIEF
                                 : PROCESS_PLAIN;
    p->pid = getpid();
    process_take_memory(p, options->agents, options->outbox);
    directory_init(&p->directory);
    p->incarnation = mu_clock_wall_ns();
    gethostname(p->host, sizeof p->host - 1);
    /* The clock makes it unique where process ids are reused. */
    snprintf(p->name, sizeof p->name, "p%ld.%llx", (long)getpid(),
             (unsigned long long)(mu_clock_wall_ns() / 1000u));
    MU_TRY(bus_enter(p, options));
    *out = p;
    return MU_OK;
}

/* @return whether the broker has all that was written, or DDS waits for another reader */
static bool last_words_are_out(mu_process *p)
{
    /* A broker that lives has them soon, and then no sample comes that would wake us. */
    int64_t most_ns = p->leaving_ns ? EXPECTANT_NS : CLOSE_PATIENCE_NS;
    p->leaving_ns = p->leaving_ns ? p->leaving_ns : mu_clock_ns();
    return bus_drain(&p->up, most_ns) || bus_writer_matches(&p->up) == 0 ||
           p->link.lives_ns > p->leaving_ns + LEAVE_PATIENCE_NS;
}

/* An agent that is gone leaves the white pages when the broker has its last mails and
 * acknowledgements: the broker takes no mail from an agent that has left, and the agent's next life
 * must not get the same mail again. */
static void agents_leave(mu_process *p, bool closes)
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

void mu_process_close(mu_process *p)
{
    if (!p || p->pid != getpid()) {
        return; /* what DDS runs in is not copied by fork */
    }
    MU_ASSERT(!p->spins);
    p->before_up = NULL; /* their state at the end is not the one to come back to */
    for (uint32_t i = 0; i < p->agent_count; i++) {
        kind_end(&p->agents[i]); /* the last mails go out with the rest */
    }
    step_flush(p);
    for (uint32_t i = 0; i < p->agent_count; i++) {
        mu_agent_set_state(&p->agents[i], MU_GONE);
    }
    step_flush(p); /* mail from on_state */
    agents_leave(p, true);
    roll_end(p);
    (void)bus_drain(&p->registration, CLOSE_PATIENCE_NS);
    bus_close(&p->bus);
}

bool mu_process_has_broker(const mu_process *p)
{
    return p->link.broker[0] && !p->link.silent && bus_reader_matches(&p->delivery) > 0;
}

const char *mu_process_broker(const mu_process *p)
{
    bool answered = p->broker_incarnation != 0 && p->broker_incarnation == p->link.incarnation;
    return answered && !p->link.silent ? p->link.broker : NULL;
}

static bool has_seen(const mu_process *p, int64_t step)
{
    return !p->sees || p->sees(p->sees_self, step);
}

/* Everything that a step needs has found its other side. */
static bool process_is_ready(const mu_process *p)
{
    return p->broker_incarnation != 0 && has_seen(p, -1) &&
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
    uint64_t now_ns = mu_clock_ns();
    bool due = now_ns - p->heartbeat_ns >= HEARTBEAT_NS;
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
    p->heartbeat_ns = now_ns;
    roll_refresh(p);
}

/* Takes the step that is there: the reader keeps only the newest. */
static void next_step(mu_process *p)
{
    enum bus_life life = BUS_LOST;
    const muster_Sense *sense = NULL;
    while (process_takes_steps(p) && life != BUS_DATA && (sense = bus_next(&p->sense, &life))) {
        p->step = NULL; /* there is another one, or its writer is lost */
    }
    if (!sense) {
        return;
    }
    sense = p->step_kept = bus_keep(&p->sense, p->step_kept);
    if (sense->step < 0) {
        (void)process_step_on(p, STEP_GREETING);
        return;
    }
    p->step_wall_ns = mu_clock_ns();
    p->lockstep_step = sense->lockstep ? sense->step : p->lockstep_step;
    p->step = sense->last ? NULL : sense;
    bool serves_the_next = sense->last && p->role == PROCESS_WATCH;
    (void)process_step_on(p, serves_the_next   ? STEP_OVER
                             : sense->last     ? STEP_LAST
                             : sense->lockstep ? STEP_LOCKSTEP
                                               : STEP_FREE);
}

/* A robot in free running takes its mail in at the next step, if one is to be expected. */
static bool mail_is_held(const mu_process *p)
{
    return p->role == PROCESS_BODY && !process_in_lockstep(p) && !p->transfers.prompt &&
           !p->transfers.under_way && p->step_wall_ns &&
           mu_clock_ns() - p->step_wall_ns < PROCESS_STEP_PATIENCE_NS;
}

/* @return whether mail in hand belongs to no step, or to the end of a lock step that is over: no
 * step comes for that any more */
static bool mail_is_for_now(const mu_process *p)
{
    bool is_over = !process_in_lockstep(p) && p->lockstep_step > 0;
    return p->mail->step == muster_STEP_NOW || (is_over && p->mail->step >= p->lockstep_step - 1);
}

/* How many samples are worth waking up for. */
static uint64_t samples_wanted(const mu_process *p)
{
    if (inbox_lacks(p) || p->up_state == UP_PENDING || (p->mail && mail_is_held(p))) {
        return 0; /* more mail may lie in the reader, and waits, too */
    }
    /* A step in lock step needs two: the senses, and the mail of the step before. */
    return process_in_lockstep(p) && !p->transfers.prompt && !p->mail && !p->step ? 2 : 1;
}

/* Mends a pair of step and mail that do not belong together: one of them is of an earlier lock
 * step, whose simulator or broker is gone.  Drops the mail if mail of another step lies behind it;
 * else drops the step if there is another one, or its writer is lost.
 * @return whether it has dropped one */
static bool pair_mend(mu_process *p)
{
    if (inbox_has_step_behind(p)) {
        inbox_drop(p);
        return true;
    }
    const muster_Sense *held = p->step;
    next_step(p);
    return p->step != held;
}

/* An earlier life may have died when its answer was with one of the two: then the broker is a step
 * ahead of the simulator, or a step behind.  @return whether the other one has been given it */
static bool repeats(mu_process *p)
{
    int64_t ahead = p->mail->step - p->step->step;
    if (p->steps != PROCESS_STEPPING || (ahead != 0 && ahead != -2)) {
        return false;
    }
    step_repeat(p, ahead == 0 ? UP_AGAIN_FOR_SIMULATOR : UP_AGAIN_FOR_BROKER);
    if (ahead == 0) {
        p->step = NULL;
    } else {
        inbox_drop(p);
    }
    return true;
}

/* @return whether something was handled */
static bool handle_one(mu_process *p)
{
    inbox_fill(p);
    probes_look(p);
    if (p->up_state == UP_PENDING) {
        return false;
    }
    if (!p->mail) {
        inbox_next(p);
    }
    if (!p->step) {
        next_step(p);
    }
    if (p->step && !p->step->lockstep) {
        step_live_freely(p, p->step);
        p->step = NULL;
        return true;
    }
    if (p->mail && mail_is_for_now(p)) {
        if (mail_is_held(p)) {
            return false;
        }
        step_take_delivery(p, p->mail, NULL);
        inbox_next(p);
        return true;
    }
    if (!p->step || !p->mail) {
        return false;
    }
    if (p->mail->step != p->step->step - 1) {
        return repeats(p) || pair_mend(p);
    }
    if (!has_seen(p, p->mail->step)) {
        return false;
    }
    step_live(p, p->step, p->mail);
    p->step = NULL;
    inbox_drop(p);
    return true;
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

static bool handle_next(mu_process *p)
{
    p->works_ns = mu_clock_ns();
    bool handled = handle_one(p);
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
        process_in_lockstep(p) ? INT64_MAX : ack_delay_wait_ns(&p->ack_delay, mu_clock_ns());
    return acks_ns < most_ns ? acks_ns : most_ns;
}

static void handle_all(mu_process *p)
{
    while (p->steps != PROCESS_DONE && step_retry(p) && handle_next(p)) {
    }
}

/* --- turns that the thread which brings mail takes itself ------------------------------------- */

/* @return whether nothing is to be done but to handle mail */
static bool may_lend(const mu_process *p)
{
    return p->role == PROCESS_BRIEF && p->runs && !p->round && !p->stopped && p->leaving == 0 &&
           !p->mail && p->up_state != UP_PENDING && p->roll.due_count == 0 &&
           mu_process_broker(p) != NULL;
}

/* Handles mail in the thread that brings it.  The thread that lent the turn does all that opens,
 * closes or waits: it goes to another broker, or sees out an agent that leaves.
 * @return whether that thread may go on waiting, as long as it wanted to */
static bool turn_take(void *self)
{
    mu_process *p = self;
    handle_all(p);
    step_flush(p);
    return may_lend(p) && mu_clock_ns() + (uint64_t)rest_ns(p) + LATE_NS >= p->looks_ns;
}

/* --- spinning --------------------------------------------------------------------------------- */

/* While the mail of a step lies there, a probe is a second sample.  While that mail is late,
 * because another process is, the first sample may be a probe. */
static void samples_await(mu_process *p, int64_t most_ns)
{
    uint64_t wanted = samples_wanted(p);
    if (wanted == 1 && may_lend(p)) {
        p->looks_ns = mu_clock_ns() + (uint64_t)most_ns;
        bus_wait_lending(&p->bus, most_ns, turn_take, p);
        return;
    }
    int64_t pair_ns = most_ns < PAIR_NS ? most_ns : PAIR_NS;
    if (wanted == 2) {
        bus_wait(&p->bus, 2, pair_ns);
        most_ns -= pair_ns;
        wanted = 1;
    }
    (process_in_lockstep(p) ? bus_wait : bus_wait_awake)(&p->bus, wanted, most_ns);
}

void process_turn(mu_process *p)
{
    handle_all(p);
    if (process_in_lockstep(p)) {
        step_say_transfers(p);
    } else {
        step_flush(p);
    }
    agents_leave(p, false);
    roll_write(p);
}

static mu_result spin(mu_process *p, int64_t timeout_ns)
{
    bool turned;
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
    process_turn(p);
    return p->steps == PROCESS_DONE ? MU_DONE : MU_OK;
}

mu_result mu_process_spin(mu_process *p, int64_t timeout_ns)
{
    if (p->spins) {
        return MU_BUSY; /* the Delivery in hand would be lost */
    }
    if (p->pid != getpid()) {
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

void mu_process_each_round(mu_process *p, void (*round)(void *self), void *self)
{
    p->round = round;
    p->round_self = self;
}

void process_see_first(mu_process *p, bool (*sees)(const void *self, int64_t step),
                       const void *self)
{
    p->sees = sees;
    p->sees_self = self;
}

void process_before_up(mu_process *p,
                       void (*before)(void *self, enum process_up_due due, int64_t step),
                       void *self)
{
    p->before_up = before;
    p->before_up_self = self;
}

bool mu_process_in_lockstep(const mu_process *p)
{
    return process_in_lockstep(p);
}

void mu_process_stop(mu_process *p)
{
    p->stopped = true;
}

const struct mu_member *mu_process_lookup(const mu_process *p, const char *name)
{
    return name ? members_find(&p->members, name) : NULL;
}

const struct mu_member *mu_process_member(const mu_process *p, size_t index)
{
    return members_at(&p->members, index);
}
