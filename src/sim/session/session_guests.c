/* SPDX-License-Identifier: Apache-2.0 */
/* Agents without a body that began while the run went on: what they do is part of it. */
#include "core/log.h"
#include "core/text.h"
#include "sim/session/session.h"

#include <string.h>

void session_guest_act(struct session *s, const muster_Act *act, int32_t process)
{
    struct guest *guest = guests_find(s->guests, act->agent);
    if (!guest || guest->process != process) {
        return;
    }
    guest->state = act->state;
    run_hash_act(s->hash, act, guest->digest);
    session_view_act(s, s->robot_count + (size_t)(guest - s->guests->at), act);
}

void session_guest_seat(struct session *s, const char *name, int32_t process)
{
    if (process >= 0 && guests_seat(s->guests, name, process) != MU_OK) {
        mu_log(MU_LOG_WARNING, "guest-left-out", "name=%s step=%lld", name, (long long)s->step);
    }
}

void session_guests_fold(struct session *s)
{
    for (uint32_t i = 0; i < s->guests->count; i++) {
        run_hash_fold(s->hash, s->guests->at[i].digest, RUN_HASH_BYTES);
    }
}

bool session_guests_live_in(const struct session *s, uint32_t process)
{
    bool any = false;
    for (uint32_t i = 0; i < s->guests->count; i++) {
        const struct guest *guest = &s->guests->at[i];
        any = any || (guest->process == (int32_t)process && guest->state != muster_STATE_ABSENT);
    }
    return any;
}

void session_guests_pass(struct session *s, uint32_t process)
{
    for (uint32_t i = 0; i < s->guests->count; i++) {
        struct guest *guest = &s->guests->at[i];
        if (guest->process == (int32_t)process) {
            memset(guest->digest, 0, sizeof guest->digest);
        }
    }
}
