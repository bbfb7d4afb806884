/* SPDX-License-Identifier: Apache-2.0 */
/* What stands before a capsule, and the pieces that both cross in. */
#include "agent/trip.h"
#include "core/name.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char *const purposes[TRIP_PURPOSES] = {
    [TRIP_MOVE] = "move", [TRIP_CLONE] = "clone", [TRIP_LAUNCH] = "launch"};

void passport_add(struct mu_text *out, const struct passport *p)
{
    mu_text_format(
        out, "passport 1 %s %s %s %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 "\n",
        purposes[p->purpose], p->name, mu_state_text(p->state), p->passage.last_number,
        p->passage.broker, p->passage.epoch, p->mails, p->seed);
}

static bool purpose_read(const char *word, enum trip_purpose *out)
{
    for (int i = 0; i < TRIP_PURPOSES; i++) {
        if (strcmp(word, purposes[i]) == 0) {
            *out = (enum trip_purpose)i;
            return true;
        }
    }
    return false;
}

/* An agent goes on in one of these states. */
static bool state_read(const char *word, enum mu_state *out)
{
    static const enum mu_state states[] = {MU_STANDBY, MU_RUNNING, MU_SUSPENDED};
    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
        if (strcmp(word, mu_state_text(states[i])) == 0) {
            *out = states[i];
            return true;
        }
    }
    return false;
}

bool passport_read(const char **text, struct passport *out)
{
    char purpose[16], name[MU_NAME_MAX + 2], state[16];
    int version = 0, len = 0;
    *out = (struct passport){.purpose = TRIP_MOVE};
    int read = sscanf(*text,
                      "passport %d %15s %32s %15s %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64
                      " %" SCNu64 "%n",
                      &version, purpose, name, state, &out->passage.last_number,
                      &out->passage.broker, &out->passage.epoch, &out->mails, &out->seed, &len);
    if (read != TRIP_FIELDS || version != 1 || (*text)[len] != '\n' || !mu_name_valid(name) ||
        mu_name_reserved(name) || !mu_text_copy(out->name, sizeof out->name, name)) {
        return false;
    }
    *text += len + 1;
    return purpose_read(purpose, &out->purpose) && state_read(state, &out->state);
}
