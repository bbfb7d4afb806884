/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Monitors of an experiment: processes beside the run.
 *
 * The run begins when they see it, so that they miss no step of it that they are fast enough for;
 * from then on no process waits for them, and their death is told and ends nothing.
 */
#include "run/run.h"

#include "core/text.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

enum { END_PATIENCE_MS = 5000 };

bool run_monitors_start(const struct run *r)
{
    return r->inputs == NULL;
}

/* Of a monitor that was started. */
static struct child *child_of(const struct run *r, unsigned index)
{
    for (uint32_t i = 0; i < r->children.count; i++) {
        if (r->parts[i].kind == RUN_MONITOR && r->parts[i].index == index) {
            return &r->children.children[i];
        }
    }
    return NULL;
}

static bool is_ready(const struct run *r, unsigned index)
{
    const struct experiment_monitor *m = &r->experiment->monitors[index];
    const struct child *child = child_of(r, index);
    const struct mu_member *member = mu_process_lookup(r->process, m->name);
    bool named = m->program != NULL || (member && member->pid == (uint32_t)child->pid);
    return supervise_is_ready(child) && (named || child->excused);
}

bool run_monitors_ready(const struct run *r)
{
    bool all = true;
    for (unsigned i = 0; run_monitors_start(r) && i < r->experiment->monitors_count; i++) {
        all = all && is_ready(r, i);
    }
    return all;
}

void run_monitors_missing(const struct run *r, char *text, size_t size)
{
    struct mu_text t = mu_text_in(text, size);
    for (unsigned i = 0; run_monitors_start(r) && i < r->experiment->monitors_count; i++) {
        if (!is_ready(r, i)) {
            mu_text_format(&t, "%s%s", t.len ? " " : "", r->experiment->monitors[i].name);
        }
    }
}

static bool is_well(const struct child *child)
{
    return WIFEXITED(child->status) && WEXITSTATUS(child->status) == 0;
}

/* Before the run begins, a monitor that has failed ends it as any other part does: its files are
 * wrong. */
static void child_look(const struct run *r, struct child *child)
{
    if (!child->ended || child->excused || !(r->begun || is_well(child))) {
        return;
    }
    child->excused = true;
    if (!run_is_over(r) || !is_well(child)) {
        char fate[SUPERVISE_FATE_MAX];
        supervise_fate(child, fate, sizeof fate);
        fprintf(stderr, "muster run: the monitor %s %s; the run goes on\n", child->name, fate);
    }
}

void run_monitors_look(struct run *r)
{
    for (unsigned i = 0; run_monitors_start(r) && i < r->experiment->monitors_count; i++) {
        child_look(r, child_of(r, i));
    }
}

void run_monitors_await(struct run *r)
{
    for (unsigned i = 0; run_monitors_start(r) && i < r->experiment->monitors_count; i++) {
        struct child *child = child_of(r, i);
        supervise_await(&r->children, child, END_PATIENCE_MS);
        r->monitors_late[i] = !child->ended;
    }
    run_monitors_look(r);
}

/* @return how it ended, for people; NULL: with the run */
static const char *fate_of(const struct run *r, unsigned index)
{
    const struct child *child = child_of(r, index);
    char fate[SUPERVISE_FATE_MAX];
    if (r->monitors_late[index]) {
        return "was too slow: it was ended 5 s after the run";
    }
    supervise_fate(child, fate, sizeof fate);
    return is_well(child) ? NULL : mu_startup_string(fate);
}

size_t run_monitors_fates(struct run *r, const struct report_monitor **out)
{
    size_t count = run_monitors_start(r) ? r->experiment->monitors_count : 0;
    struct report_monitor *fates = mu_startup_array(count, sizeof *fates);
    for (unsigned i = 0; i < count; i++) {
        const struct experiment_monitor *m = &r->experiment->monitors[i];
        fates[i] = (struct report_monitor){
            .name = m->name, .rules = m->rules, .program = m->program, .fate = fate_of(r, i)};
    }
    *out = fates;
    return count;
}
