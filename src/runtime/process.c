/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/process.h"

#include "core/built.h"
#include "core/clock.h"
#include "core/forks.h"
#include "core/name.h"
#include "core/signals.h"
#include "muster/kind.h"
#include "muster/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* How long a process that ends waits for the network to take its last words. */
static const int64_t CLOSE_PATIENCE_NS = 200000000;

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
    p->handlers_size = sizeof(struct mu_handlers);
    p->base_kind = &mu_base_kind;
}

static bool options_fit(const struct mu_process_options *options)
{
    return options->agents <= MU_LOCAL_AGENTS_MAX && options->outbox <= MU_OUTBOX_MOST &&
           !(options->with_body && options->watches);
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

/* The environment's domain, for a program that names none. */
static mu_result domain_find(int *domain)
{
    const char *text = getenv("MUSTER_DOMAIN");
    if (*domain != 0 || !text || !*text) {
        return MU_OK;
    }
    char *end, shown[MU_TEXT_SHOWN];
    long number = strtol(text, &end, 10);
    if (*end || number < 0 || number > MU_DOMAIN_MAX) {
        fprintf(stderr, "MUSTER_DOMAIN=%s: expected a whole number from 0 to %d\n",
                mu_text_show(shown, text), MU_DOMAIN_MAX);
        return MU_FAULT_USAGE;
    }
    *domain = (int)number;
    return MU_OK;
}

static const struct built_struct structs[] = {
    {"mu_process_options", sizeof(struct mu_process_options), true},
    {"mu_handlers", sizeof(struct mu_handlers), true},
    {"mu_mail", sizeof(struct mu_mail), false},
    {"mu_percept", sizeof(struct mu_percept), false},
    {"mu_blob", sizeof(struct mu_blob), false},
    {"mu_fiducial", sizeof(struct mu_fiducial), false},
    {"mu_passage", sizeof(struct mu_passage), false},
    {"mu_member", sizeof(struct mu_member), true},
    {"mu_service", sizeof(struct mu_service), true},
    {"mu_layer_handler", sizeof(struct mu_layer_handler), false},
    {"mu_agent_kind", sizeof(struct mu_agent_kind), false}};

mu_result(mu_process_open)(mu_process **out, const struct mu_process_options *options)
{
    return mu_process_open(out, options);
}

mu_result mu_process_open_built(mu_process **out, const struct mu_process_options *options,
                                const char *version, const uint32_t *sizes)
{
    if (!built_fits(version, sizes, structs, sizeof structs / sizeof structs[0])) {
        return MU_FAULT_USAGE;
    }
    struct mu_process_options own = {0};
    if (options) {
        memcpy(&own, options, sizes[0]);
    }
    MU_TRY(domain_find(&own.domain));
    own.domain = own.domain == MU_DOMAIN_ZERO ? 0 : own.domain;
    own.broker = own.broker ? own.broker : getenv("MUSTER_BROKER");
    options = &own;
    if (!options_fit(options)) {
        return MU_FAULT_USAGE;
    }
    mu_process *p = mu_startup_alloc(sizeof *p);
    p->role = options->with_body ? PROCESS_BODY : options->watches ? PROCESS_WATCH : PROCESS_PLAIN;
    p->forks = mu_forks();
    process_take_memory(p, options->agents, options->outbox);
    p->handlers_size = sizes[1];
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

void mu_process_close(mu_process *p)
{
    if (!p || p->forks != mu_forks()) {
        return; /* what DDS runs in is not copied by fork */
    }
    MU_ASSERT(!p->spins);
    p->before_up = NULL; /* their state at the end is not the one to come back to */
    for (uint32_t i = 0; i < p->agent_count; i++) {
        kind_end(&p->agents[i]); /* the last mails go out with the rest */
    }
    step_flush(p);
    process_see_out(p, true); /* those that were disposed of: the others' names stay */
    roll_write(p);
    for (uint32_t i = 0; i < p->agent_count; i++) {
        mu_agent_set_state(&p->agents[i], MU_GONE);
    }
    step_flush(p); /* mail from on_state */
    process_see_out(p, true);
    (void)bus_drain(&p->registration, CLOSE_PATIENCE_NS);
    roll_end(p);
    (void)bus_drain(&p->registration, CLOSE_PATIENCE_NS);
    bus_close(&p->bus);
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
    return name ? members_find(&p->members, mu_name_now(name)) : NULL;
}

const struct mu_member *mu_process_member(const mu_process *p, size_t index)
{
    return members_at(&p->members, index);
}
