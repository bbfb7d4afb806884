/* SPDX-License-Identifier: Apache-2.0 */
/* The ports of a mind: what it can ask of its robot. */
#include "agent/robot.h"
#include "core/exits.h"
#include "core/signals.h"
#include "runtime/process.h"

#include <stdio.h>
#include <unistd.h>

/* The simulator waits 5 s for a step. */
enum { STUCK_MS = 3000 };

static mu_result port_send(void *self, const struct mind_letter *letter)
{
    struct robot *r = self;
    struct mu_mail mail = {.dst = letter->dst,
                           .directive = letter->directive,
                           .performative = letter->performative,
                           .language = letter->language,
                           .ontology = letter->ontology,
                           .reply_with = letter->reply_with,
                           .in_reply_to = letter->in_reply_to,
                           .conversation = letter->conversation,
                           .content = letter->content,
                           .layer = letter->layer,
                           .priority = letter->priority,
                           .level = letter->level,
                           .reply_by_ns = letter->reply_by_ns,
                           .ttl_ns = letter->ttl_ns};
    return mu_agent_send(r->agent, &mail, NULL);
}

static void member_fill(struct mind_member *to, const struct mu_member *from)
{
    *to = (struct mind_member){.name = from->name,
                               .kind = mu_kind_text(from->kind),
                               .state = mu_state_text(from->state),
                               .host = from->host};
}

static mu_result port_lookup(void *self, const char *name, struct mind_member *out)
{
    struct robot *r = self;
    const struct mu_member *member = mu_process_lookup(r->group->process, name);
    if (!member) {
        return MU_ABSENT;
    }
    member_fill(out, member);
    return MU_OK;
}

static mu_result port_listing(void *self, size_t index, struct mind_member *out)
{
    struct robot *r = self;
    const struct mu_member *member = mu_process_member(r->group->process, index);
    if (!member) {
        return MU_DONE;
    }
    member_fill(out, member);
    return MU_OK;
}

static mu_result port_change(void *self, enum mind_change change, const char *name,
                             const char *attributes, uint64_t lease_ns)
{
    mu_agent *a = ((struct robot *)self)->agent;
    switch (change) {
    case MIND_RESOLVE: return join_resolve(self);
    case MIND_GROUP_CREATE: return mu_agent_group_create(a, name);
    case MIND_GROUP_JOIN: return mu_agent_group_join(a, name);
    case MIND_GROUP_LEAVE: return mu_agent_group_leave(a, name);
    case MIND_ADVERTISE: return mu_agent_advertise(a, name, attributes, lease_ns);
    case MIND_WITHDRAW: return mu_agent_withdraw(a, name);
    }
    return MU_MALFORMED;
}

static const char *port_entry(void *self, enum mind_list list, const char *of, size_t index)
{
    const mu_process *p = ((struct robot *)self)->group->process;
    const struct mu_service *service;
    switch (list) {
    case MIND_GROUPS: return mu_process_group(p, index);
    case MIND_MEMBERS: return mu_process_group_member(p, of, index);
    case MIND_PROVIDERS:
        service = mu_process_find_service(p, of, index);
        return service ? service->agent : NULL;
    }
    return NULL;
}

static const char *port_aside(void *self, size_t index)
{
    return aside_entry(self, index);
}

static bool port_drop_aside(void *self, size_t index)
{
    return aside_drop(self, index);
}

/* One write, so that the lines of robots that share a terminal do not mix. */
static void print_flush(struct robot *r)
{
    r->print[r->print_len++] = '\n';
    int to = r->group->prints ? STDOUT_FILENO : STDERR_FILENO;
    ssize_t written = write(to, r->print, r->print_len);
    (void)written; /* a failure cannot be reported */
    r->print_len = 0;
}

/* Rules print in pieces; whole lines go out, each with the robot's name. */
static void port_print(void *self, const char *text)
{
    struct robot *r = self;
    (void)console_print(r, text); /* consoles get a copy */
    for (const char *c = text; *c; c++) {
        if (*c != '\n' && r->print_len == ROBOT_PRINT_MAX - 1) {
            print_flush(r);
        }
        if (r->print_len == 0 && !r->group->prints) {
            r->print_len = (size_t)snprintf(r->print, sizeof r->print, "%s: ", r->name);
        }
        if (*c == '\n') {
            print_flush(r);
        } else {
            r->print[r->print_len++] = *c;
        }
    }
}

static bool port_trace(void *self, const char *text)
{
    return console_print(self, text);
}

static void port_work(void *self)
{
    struct robot *r = self;
    if (r->group->process) { /* else it loads its rules */
        process_work(r->group->process);
    }
}

/* In lock step no other process would get stuck at the same time and hold up the run. */
static int port_stuck(void *self, unsigned ms)
{
    const struct robot *r = self;
    if (mu_signal_came) {
        return MU_EXIT_INTERRUPTED;
    }
    if (ms < STUCK_MS || !r->group->process) {
        return MIND_WAITS;
    }
    return mu_process_in_lockstep(r->group->process) ? MU_EXIT_CRASH : MIND_BREAKS;
}

struct mind_ports ports_of(struct robot *r)
{
    return (struct mind_ports){.self = r,
                               .send = port_send,
                               .lookup = port_lookup,
                               .listing = port_listing,
                               .change = port_change,
                               .entry = port_entry,
                               .aside = port_aside,
                               .drop_aside = port_drop_aside,
                               .trace = port_trace,
                               .work = port_work,
                               .stuck = port_stuck,
                               .print = port_print};
}

void ports_print_rest(struct robot *r)
{
    if (r->print_len > 0) {
        print_flush(r);
    }
}
