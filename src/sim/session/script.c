/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/session/script.h"

#include "muster/memory.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { SCRIPT_EVENTS_MAX = 64, SCRIPT_BUFFER = 64 * 1024 };

struct later {
    struct order order;
    struct condition_watch watch; /* if the order has a condition */
    bool waits, due;
};

struct script {
    const struct condition_names *names;
    struct later later[MU_ORDERS_LATER_MAX];
    size_t later_count; /* slots that have been used */
    struct condition_watch events[SCRIPT_EVENTS_MAX];
    const char *texts[SCRIPT_EVENTS_MAX];
    size_t events_count;
    FILE *file;
    const char *path;
    char buffer[SCRIPT_BUFFER];
};

struct script *script_open(const struct condition_names *names)
{
    struct script *s = mu_startup_alloc(sizeof *s);
    s->names = names;
    return s;
}

static mu_result script_fault(const struct script *s, const char *what)
{
    fprintf(stderr, "cannot %s %s: %s\n", what, s->path, strerror(errno));
    return MU_FAULT_OS;
}

mu_result script_record(struct script *s, const char *path, const char *const *events, size_t count)
{
    char why[CONDITION_WHY_MAX];
    for (size_t i = 0; i < count; i++) {
        if (i == SCRIPT_EVENTS_MAX) {
            fprintf(stderr, "muster sim: expected at most %d events\n", SCRIPT_EVENTS_MAX);
            return MU_FAULT_USAGE;
        }
        if (condition_read(&s->events[i].condition, events[i], s->names, why) != MU_OK) {
            fprintf(stderr, "muster sim: event '%s': %s\n", events[i], why);
            return MU_FAULT_USAGE;
        }
        s->texts[i] = events[i];
        s->events_count++;
    }
    s->path = path;
    s->file = fopen(path, "we");
    if (!s->file) {
        return script_fault(s, "create");
    }
    setvbuf(s->file, s->buffer, _IOFBF, sizeof s->buffer);
    fputs("time_s,event\n", s->file);
    return MU_OK;
}

/* @return a free slot, or NULL */
static struct later *later_take(struct script *s)
{
    for (size_t i = 0; i < s->later_count; i++) {
        if (!s->later[i].waits) {
            return &s->later[i];
        }
    }
    return s->later_count < MU_ORDERS_LATER_MAX ? &s->later[s->later_count++] : NULL;
}

mu_result script_put(struct script *s, const muster_RunCommand *command, char *why)
{
    struct condition_watch watch = {.was = false};
    if (command->when[0]) {
        mu_result read = condition_read(&watch.condition, command->when, s->names, why);
        if (read != MU_OK) {
            return read;
        }
    }
    struct later *later = later_take(s);
    if (!later) {
        return MU_FULL;
    }
    order_queue_copy(&later->order, command);
    later->watch = watch;
    later->waits = true;
    later->due = false;
    return MU_OK;
}

static void watch_act(struct condition_watch *w, int robot, const muster_Act *act)
{
    condition_note_rules(w, robot, act->rules);
    for (uint32_t i = 0; i < act->mails._length; i++) {
        const muster_Mail *mail = &act->mails._buffer[i];
        condition_note_mail(w, robot, mail->content, mail->dst);
    }
}

void script_act(struct script *s, int robot, const muster_Act *act)
{
    for (size_t i = 0; i < s->events_count; i++) {
        watch_act(&s->events[i], robot, act);
    }
    for (size_t i = 0; i < s->later_count; i++) {
        if (s->later[i].waits && s->later[i].order.command.when[0]) {
            watch_act(&s->later[i].watch, robot, act);
        }
    }
}

void script_look(struct script *s, uint64_t time_ns, const struct condition_view *view)
{
    for (size_t i = 0; i < s->events_count; i++) {
        if (condition_watch_look(&s->events[i], view)) {
            fprintf(s->file, "%.3f,%s\n", (double)time_ns * 1e-9, s->texts[i]);
        }
    }
    for (size_t i = 0; i < s->later_count; i++) {
        struct later *later = &s->later[i];
        const muster_RunCommand *c = &later->order.command;
        if (later->waits && !later->due) {
            if (c->when[0]) {
                (void)condition_watch_look(&later->watch, view);
            }
            later->due = (!c->when[0] || later->watch.was) && time_ns >= c->due_ns;
        }
    }
}

const muster_RunCommand *script_next(struct script *s)
{
    for (size_t i = 0; i < s->later_count; i++) {
        struct later *later = &s->later[i];
        if (later->waits && later->due) {
            later->waits = later->due = false;
            return &later->order.command;
        }
    }
    return NULL;
}

mu_result script_close(struct script *s)
{
    if (!s->file) {
        return MU_OK;
    }
    bool whole = !ferror(s->file);
    whole = fclose(s->file) == 0 && whole;
    s->file = NULL;
    return whole ? MU_OK : script_fault(s, "write");
}
