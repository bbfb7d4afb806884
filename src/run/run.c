/* SPDX-License-Identifier: Apache-2.0 */
/* What all files of a run ask it: its parts and their names, what comes back, what was counted. */
#include "run/run.h"

#include "core/text.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

unsigned run_brokers(const struct run *r)
{
    return r->experiment->brokers_count > 0 ? r->experiment->brokers_count : 1;
}

const char *run_broker(const struct run *r, unsigned index)
{
    return r->experiment->brokers_count > 0 ? r->experiment->brokers[index] : "main";
}

void run_child_name(const struct run *r, unsigned index, char *name)
{
    snprintf(name, RUN_CHILD_MAX, "broker%s%s", index ? "." : "",
             index ? run_broker(r, index) : "");
}

struct run_part run_part_of(const struct run *r, const struct child *child)
{
    return r->parts[child - r->children.children];
}

const struct experiment_crew *run_controller(const struct run *r, const struct child *child)
{
    struct run_part part = run_part_of(r, child);
    const struct experiment *e = r->experiment;
    const struct experiment_crew *crew = part.kind == RUN_CREW ? &e->crews[part.index] : NULL;
    return crew && e->robots[crew->robot].controller.program ? crew : NULL;
}

char *run_robot_name(const struct run *r, const char *name)
{
    struct world_robot *robot = world_find_robot(r->world, name);
    int agent = robot ? -1 : experiment_robot_find(r->experiment, name);
    return robot ? robot->name : agent >= 0 ? r->experiment->robots[agent].name : NULL;
}

bool run_pages_own(const struct run *r, const struct experiment_robot *robot)
{
    return robot->broker && strcmp(robot->broker, run_broker(r, 0)) != 0;
}

void run_command_write(const struct run *r, char *buffer, size_t size)
{
    struct mu_text t = mu_text_in(buffer, size);
    mu_text_format(&t, "muster run %s --seed %" PRIu64 " --duration %g", r->options.file,
                   r->experiment->seed, r->experiment->duration);
    for (size_t i = 0; i < r->options.set_count; i++) {
        mu_text_format(&t, " --set '%s'", r->options.set[i]);
    }
    if (r->options.free) {
        mu_text_add(&t, " --free");
    }
    if (r->options.programs) {
        mu_text_add(&t, " --programs");
    }
}

void run_objects_take(struct run *r, const muster_ObjectPlace *places, size_t count)
{
    r->objects_count = count == r->world->object_count ? count : 0;
    for (size_t i = 0; i < r->objects_count; i++) {
        r->objects[i] = (struct world_pose){places[i].x_m, places[i].y_m, places[i].heading_rad};
    }
}

mu_result run_go_send(struct run *r, uint64_t seq)
{
    static char observer[] = "observer", none[1];
    muster_RunCommand go = {.simulator = r->simulator,
                            .source = observer,
                            .seq = seq,
                            .order = muster_RUN_GO,
                            .name = none,
                            .file = none,
                            .when = none};
    return bus_write(&r->command, &go);
}

/* --- what is started again -------------------------------------------------------------------- */

static bool crew_restarts(const struct run *r, unsigned crew)
{
    const struct experiment *e = r->experiment;
    return e->robots[e->crews[crew].robot].on_crash == EXPERIMENT_RESTART;
}

bool run_restarts_any(const struct run *r)
{
    const struct experiment *e = r->experiment;
    bool any = e->on_crash == EXPERIMENT_RESTART;
    for (unsigned i = 0; i < e->crews_count; i++) {
        any = any || crew_restarts(r, i);
    }
    return any;
}

bool run_restarts_brokers(const struct run *r)
{
    return r->experiment->on_crash == EXPERIMENT_RESTART && r->options.free;
}

bool run_remembers(const struct run *r, const struct child *child)
{
    struct run_part part = run_part_of(r, child);
    const struct experiment *e = r->experiment;
    return part.kind == RUN_CREW && crew_restarts(r, part.index) &&
           e->robots[e->crews[part.index].robot].checkpoint_s > 0;
}

static bool part_restarts(const struct run *r, struct run_part part)
{
    switch (part.kind) {
    case RUN_BROKER: return run_restarts_brokers(r);
    case RUN_RESOLVER:
    case RUN_HOST: return r->experiment->on_crash == EXPERIMENT_RESTART;
    case RUN_CREW: return crew_restarts(r, part.index);
    case RUN_SIMULATOR: /* the world is in it alone */
    case RUN_MONITOR:
    case RUN_PAGE: break;
    }
    return false;
}

bool run_restarts(const struct run *r, const struct child *child)
{
    return part_restarts(r, run_part_of(r, child));
}

/* --- mail, over all lives of the brokers ------------------------------------------------------ */

static void mail_add(struct report_mail *m, const muster_BrokerStatus *b)
{
    if (b->lockstep.ended > 0) {
        m->sent += b->lockstep.sent;
        m->delivered += b->lockstep.delivered;
        m->waiting += b->lockstep.waiting;
        m->expired += b->lockstep.expired;
        m->refused += b->lockstep.refused;
        return;
    }
    m->sent += b->sent;
    m->delivered += b->delivered;
    m->waiting += b->waiting;
    m->expired += b->expired;
    m->refused +=
        b->box_full + b->over_share + b->unknown_name + b->refused + b->dropped + b->no_store;
}

/* What waits in it may wait in its next life, too. */
void run_mail_keep(struct run *r, const char *child)
{
    char name[RUN_CHILD_MAX];
    for (unsigned i = 0; i < run_brokers(r); i++) {
        run_child_name(r, i, name);
        if (strcmp(name, child) == 0) {
            mail_add(&r->mail_before[i], &r->mail[i]);
            r->mail[i] = (muster_BrokerStatus){.broker = NULL};
        }
    }
}

struct report_mail run_mail_of(const struct run *r)
{
    struct report_mail m = {0};
    for (unsigned i = 0; i < run_brokers(r); i++) {
        mail_add(&m, &r->mail[i]);
    }
    for (unsigned i = 0; i < run_brokers(r); i++) {
        const struct report_mail *before = &r->mail_before[i];
        m.sent += before->sent;
        m.delivered += before->delivered;
        m.expired += before->expired;
        m.refused += before->refused;
    }
    uint64_t accounted = m.delivered + m.waiting + m.expired + m.refused;
    m.lost = m.sent > accounted ? m.sent - accounted : 0;
    for (uint32_t i = 0; i < r->totals_count; i++) {
        m.duplicated += r->totals[i].mails_duplicated;
    }
    return m;
}

/* --- parts whose packets may be struck -------------------------------------------------------- */

unsigned run_struck_find(const struct run *r, const char *child)
{
    for (unsigned i = 1; i <= r->struck_count; i++) {
        if (strcmp(r->struck[i], child) == 0) {
            return i;
        }
    }
    return 0;
}

void run_struck_next(const struct run *r, const char *child)
{
    if (r->traffic) {
        traffic_child(run_struck_find(r, child));
    }
}
