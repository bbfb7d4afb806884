/* SPDX-License-Identifier: Apache-2.0 */
#include "web/run_json.h"

#include "core/text.h"

static bool has_ended(const struct run_json *r)
{
    return r->state == muster_RUN_DONE || r->state == muster_RUN_FAULT;
}

bool run_json_lives(const struct run_json *r)
{
    return r->simulator && !has_ended(r);
}

void run_json_lose(struct run_json *r)
{
    r->simulator = r->simulator && has_ended(r);
}

void run_json_take(struct run_json *r, const muster_RunStatus *status)
{
    r->simulator = true;
    r->state = status->state;
    r->step = status->step;
    r->time_ns = status->time_ns;
    r->wall_ns = status->wall_ns;
    r->duration_ns = status->duration_ns;
    r->skipped = status->skipped;
    mu_text_copy(r->hash, sizeof r->hash, status->hash);
    mu_text_copy(r->waits_for, sizeof r->waits_for, status->waits_for);
}

static const char *state_text(const struct run_json *r)
{
    static const char *const texts[] = {[muster_RUN_WAITING] = "waiting",
                                        [muster_RUN_READY] = "ready",
                                        [muster_RUN_RUNNING] = "running",
                                        [muster_RUN_DONE] = "done",
                                        [muster_RUN_FAULT] = "fault"};
    bool known = (unsigned)r->state < sizeof texts / sizeof texts[0];
    return r->simulator && known ? texts[r->state] : "none";
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
    mu_json_string(j, "broker", r->broker);
    mu_json_list(j, "mails");
    const uint64_t mails[] = {r->sent, r->delivered, r->waiting, r->expired, r->refused};
    for (size_t i = 0; i < sizeof mails / sizeof mails[0]; i++) {
        mu_json_uint(j, NULL, mails[i]);
    }
    mu_json_end(j);
    mu_json_end(j);
}
