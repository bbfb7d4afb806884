/* SPDX-License-Identifier: Apache-2.0 */
/* events.csv, which the simulator writes: when each condition came true. */
#include "muster/memory.h"
#include "report/report_data.h"
#include "world/condition/condition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char events_header[] = "time_s,event";

enum { EVENTS_LINE_MAX = CONDITION_TEXT_MAX + 64 };

/* A row: the time, and the condition as the experiment has it. */
static mu_result row_take(struct report_data *data, const char *path, int number, char *line,
                          struct mu_fault *fault)
{
    char *end;
    size_t len = strlen(line);
    if (len == 0 || line[len - 1] != '\n') {
        return mu_fault_at(fault, path, number, 0, "expected a whole line of text");
    }
    line[len - 1] = '\0';
    double time_s = strtod(line, &end);
    if (end == line || *end != ',' || !isfinite(time_s)) {
        return mu_fault_at(fault, path, number, 1, "expected a time and an event");
    }
    unsigned event = experiment_event_find(data->input->experiment, end + 1);
    if (event == EXPERIMENT_EVENTS_MAX) {
        return mu_fault_at(fault, path, number, 0, "no event '%.80s' in this experiment", end + 1);
    }
    struct report_events *events = data->events;
    if (events->count < REPORT_EVENTS_MAX) {
        events->at[events->count++] =
            (struct report_event){.time_s = (float)time_s, .event = (uint16_t)event};
    } else {
        events->left_out++;
    }
    return MU_OK;
}

mu_result report_events_read(struct report_data *data, const char *folder, struct mu_fault *fault)
{
    char path[REPORT_PATH_MAX], line[EVENTS_LINE_MAX];
    data->events = mu_startup_alloc(sizeof *data->events);
    if (data->input->experiment->events_count == 0) {
        return MU_OK;
    }
    snprintf(path, sizeof path, "%s/events.csv", folder);
    FILE *file = fopen(path, "re");
    if (!file) {
        return mu_fault_os(fault, path, "read");
    }
    mu_result read = MU_OK;
    for (int number = 1; read == MU_OK && fgets(line, sizeof line, file); number++) {
        if (number > 1) {
            read = row_take(data, path, number, line, fault);
        } else if (strncmp(line, events_header, sizeof events_header - 1) != 0) {
            read = mu_fault_at(fault, path, 1, 1, "expected the line '%s'", events_header);
        }
    }
    fclose(file);
    return read;
}

size_t report_events_next(const struct report_events *events, unsigned event, size_t from)
{
    while (from < events->count && events->at[from].event != event) {
        from++;
    }
    return from;
}
