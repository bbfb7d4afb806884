/* SPDX-License-Identifier: Apache-2.0 */
#include "web/json.h"

#include "core/text.h"

#include <string.h>

static bool has_ended(const struct run_json *r)
{
    return r->state == muster_RUN_DONE || r->state == muster_RUN_FAULT;
}

bool run_json_has_ended(const struct run_json *r)
{
    return r->simulator[0] && has_ended(r);
}

bool run_json_lives(const struct run_json *r)
{
    return r->simulator[0] && !has_ended(r);
}

/* It may be that of the run before, of which that is found out late. */
void run_json_lose(struct run_json *r, const char *simulator)
{
    if (strcmp(r->simulator, simulator) == 0 && !has_ended(r)) {
        r->simulator[0] = '\0';
    }
}

void run_json_take(struct run_json *r, const muster_RunStatus *status)
{
    mu_text_copy(r->simulator, sizeof r->simulator, status->simulator);
    r->state = status->state;
    r->report[0] = '\0';
    r->step = status->step;
    r->time_ns = status->time_ns;
    r->wall_ns = status->wall_ns;
    r->duration_ns = status->duration_ns;
    r->skipped = status->skipped;
    mu_text_copy(r->hash, sizeof r->hash, status->hash);
    mu_text_copy(r->waits_for, sizeof r->waits_for, status->waits_for);
}

/* --- brokers ---------------------------------------------------------------------------------- */

/* @return a broker, new where it was not known; NULL: there are too many */
static struct run_broker *broker_find(struct run_json *r, const char *name)
{
    struct run_broker *place = NULL;
    for (size_t i = 0; i < MU_BROKERS_MAX; i++) {
        struct run_broker *b = &r->brokers[i];
        if (strcmp(b->name, name) == 0) {
            return b;
        }
        place = !place && !b->name[0] ? b : place;
    }
    if (place) {
        *place = (struct run_broker){.there = false};
        mu_text_copy(place->name, sizeof place->name, name);
    }
    return place;
}

void run_json_broker(struct run_json *r, const char *name, bool there)
{
    struct run_broker *b = broker_find(r, name);
    if (b) {
        b->there = there;
    }
}

void run_json_mails(struct run_json *r, const muster_BrokerStatus *status)
{
    struct run_broker *b = broker_find(r, status->broker);
    if (b) {
        b->sent = status->sent;
        b->delivered = status->delivered;
        b->waiting = status->waiting;
        b->expired = status->expired;
        b->refused = status->box_full + status->over_share + status->unknown_name +
                     status->refused + status->dropped + status->no_store;
    }
}

void run_json_begin(struct run_json *r)
{
    for (size_t i = 0; i < MU_BROKERS_MAX; i++) {
        if (!r->brokers[i].there) {
            r->brokers[i].name[0] = '\0';
        }
    }
}

static const char *broker_there(const struct run_json *r)
{
    for (size_t i = 0; i < MU_BROKERS_MAX; i++) {
        if (r->brokers[i].name[0] && r->brokers[i].there) {
            return r->brokers[i].name;
        }
    }
    return "";
}

/* --- JSON ------------------------------------------------------------------------------------- */

static const char *state_text(const struct run_json *r)
{
    static const char *const texts[] = {[muster_RUN_WAITING] = "waiting",
                                        [muster_RUN_READY] = "ready",
                                        [muster_RUN_RUNNING] = "running",
                                        [muster_RUN_DONE] = "done",
                                        [muster_RUN_FAULT] = "fault"};
    bool known = (unsigned)r->state < sizeof texts / sizeof texts[0];
    return r->simulator[0] && known ? texts[r->state] : "none";
}

static void mails_write(struct mu_json *j, const struct run_json *r)
{
    uint64_t mails[5] = {0};
    for (size_t i = 0; i < MU_BROKERS_MAX; i++) {
        const struct run_broker *b = &r->brokers[i];
        const uint64_t own[] = {b->sent, b->delivered, b->waiting, b->expired, b->refused};
        for (size_t k = 0; k < 5 && b->name[0]; k++) {
            mails[k] += own[k];
        }
    }
    mu_json_list(j, "mails");
    for (size_t k = 0; k < 5; k++) {
        mu_json_uint(j, NULL, mails[k]);
    }
    mu_json_end(j);
}

void run_json_write(struct mu_json *j, const struct run_json *r)
{
    mu_json_object(j, NULL);
    mu_json_string(j, "state", state_text(r));
    mu_json_int(j, "step", r->step);
    mu_json_uint(j, "time_ms", r->time_ns / 1000000u);
    mu_json_uint(j, "wall_ms", r->wall_ns / 1000000u);
    mu_json_uint(j, "duration_ms", r->duration_ns / 1000000u);
    mu_json_uint(j, "skipped", r->skipped);
    mu_json_string(j, "hash", r->hash);
    mu_json_string(j, "waits_for", r->waits_for);
    mu_json_string(j, "broker", broker_there(r));
    mails_write(j, r);
    mu_json_string(j, "report", r->report);
    mu_json_end(j);
}
