/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "core/csv.h"
#include "muster/memory.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { EVENTS_MAX = 64, EVENTS_BUFFER = 64 * 1024 };

struct events {
    struct condition_watch at[EVENTS_MAX];
    const char *texts[EVENTS_MAX];
    size_t count;
    FILE *file;
    const char *path;
    char buffer[EVENTS_BUFFER];
};

/* --- conditions of a run ---------------------------------------------------------------------- */

int record_find_body(const struct world *world, const char *name)
{
    for (size_t i = 0; i < world->robot_count; i++) {
        if (strcmp(world->robots[i].name, name) == 0) {
            return (int)i;
        }
    }
    for (size_t i = 0; i < world->object_count; i++) {
        if (strcmp(world->objects[i].name, name) == 0) {
            return (int)(world->robot_count + i);
        }
    }
    return -1;
}

static int body_find(const void *self, const char *name)
{
    return record_find_body(self, name);
}

static int agent_find(const void *agents, const char *name)
{
    const struct mu_option_list *list = agents;
    for (size_t i = 0; i < list->count; i++) {
        if (strcmp(list->items[i], name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

struct condition_names record_names(const struct world *world, const struct mu_option_list *agents)
{
    return (struct condition_names){.find = body_find,
                                    .self = world,
                                    .robots = (int)world->robot_count,
                                    .find_agent = agent_find,
                                    .agents = agents};
}

void record_note_act(struct condition_watch *w, int agent, const muster_Act *act)
{
    condition_note_rules(w, agent, act->rules);
    for (uint32_t i = 0; i < act->mails._length; i++) {
        const muster_Mail *mail = &act->mails._buffer[i];
        condition_note_mail(w, agent, mail->content, mail->dst);
    }
}

/* --- the file --------------------------------------------------------------------------------- */

static mu_result events_fault(const struct events *e, const char *what)
{
    fprintf(stderr, "cannot %s %s: %s\n", what, e->path, strerror(errno));
    return MU_FAULT_OS;
}

mu_result events_open(struct events **out, const char *path, const struct mu_option_list *texts,
                      const struct condition_names *names)
{
    char why[CONDITION_WHY_MAX];
    struct events *e = mu_startup_alloc(sizeof *e);
    for (size_t i = 0; i < texts->count; i++) {
        if (i == EVENTS_MAX) {
            fprintf(stderr, "muster sim: expected at most %d events\n", EVENTS_MAX);
            return MU_FAULT_USAGE;
        }
        if (condition_read(&e->at[i].condition, texts->items[i], names, why) != MU_OK) {
            fprintf(stderr, "muster sim: event '%s': %s\n", texts->items[i], why);
            return MU_FAULT_USAGE;
        }
        e->texts[i] = texts->items[i];
        e->count++;
    }
    e->path = path;
    e->file = fopen(path, "we");
    if (!e->file) {
        return events_fault(e, "create");
    }
    setvbuf(e->file, e->buffer, _IOFBF, sizeof e->buffer);
    fputs(MU_CSV_EVENTS_HEAD, e->file);
    *out = e;
    return MU_OK;
}

void events_note_act(struct events *e, int robot, const muster_Act *act)
{
    for (size_t i = 0; i < e->count; i++) {
        record_note_act(&e->at[i], robot, act);
    }
}

void events_look(struct events *e, uint64_t time_ns, const struct condition_view *view)
{
    for (size_t i = 0; i < e->count; i++) {
        if (condition_watch_look(&e->at[i], view)) {
            mu_csv_event(e->file, time_ns, e->texts[i]);
        }
    }
}

mu_result events_close(struct events *e)
{
    bool whole = !ferror(e->file);
    whole = fclose(e->file) == 0 && whole;
    return whole ? MU_OK : events_fault(e, "write");
}
