/* SPDX-License-Identifier: Apache-2.0 */
/* The header of a snapshot, and a whole agent behind it. */
#include "agent/robot.h"
#include "core/name.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char *const purposes[MIGRATION_PURPOSES] = {
    [MIGRATION_MOVE] = "move", [MIGRATION_CLONE] = "clone", [MIGRATION_LAUNCH] = "launch"};

void snapshot_header_add(struct mu_text *out, const struct snapshot_header *p)
{
    mu_text_format(out,
                   "passport 3 %s %s %s %s %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64
                   " %" PRIu64 " %" PRIu32 " %s %s\n",
                   mu_kind_text(p->passage.kind), purposes[p->purpose], p->name,
                   mu_state_text(p->state), p->passage.last_number, p->passage.handed,
                   p->passage.broker, p->passage.epoch, p->mails, p->seed, p->rules_left,
                   p->asker[0] ? p->asker : "-", p->reply_with);
}

static bool purpose_read(const char *word, enum migration_purpose *out)
{
    for (int i = 0; i < MIGRATION_PURPOSES; i++) {
        if (strcmp(word, purposes[i]) == 0) {
            *out = (enum migration_purpose)i;
            return true;
        }
    }
    return false;
}

/* Reads a kind that has rules. */
static bool kind_read(const char *word, enum mu_kind *out)
{
    *out = strcmp(word, mu_kind_text(MU_KIND_ROBOT)) == 0 ? MU_KIND_ROBOT : MU_KIND_AGENT;
    return strcmp(word, mu_kind_text(*out)) == 0;
}

/* Reads a state that an agent can go on in. */
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

/* Reads the asker and its label, which ends the line.  @return false: they do not fit */
static bool asker_read(const char **text, struct snapshot_header *out)
{
    char asker[MU_NAME_MAX + 2];
    int len = 0;
    size_t line = strcspn(*text, "\n");
    if (sscanf(*text, " %32s%n", asker, &len) != 1 || (*text)[len] != ' ' ||
        (*text)[line] == '\0' || line - (size_t)len - 1 > MU_FIELD_MAX) {
        return false;
    }
    memcpy(out->reply_with, *text + len + 1, line - (size_t)len - 1);
    *text += line + 1;
    return strcmp(asker, "-") == 0 ||
           (mu_name_valid(asker) && mu_text_copy(out->asker, sizeof out->asker, asker));
}

bool snapshot_header_read(const char **text, struct snapshot_header *out)
{
    char kind[16], purpose[16], name[MU_NAME_MAX + 2], state[16];
    int version = 0, len = 0;
    *out = (struct snapshot_header){.purpose = MIGRATION_MOVE};
    int read = sscanf(*text,
                      "passport %d %15s %15s %32s %15s %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64
                      " %" SCNu64 " %" SCNu64 " %" SCNu32 "%n",
                      &version, kind, purpose, name, state, &out->passage.last_number,
                      &out->passage.handed, &out->passage.broker, &out->passage.epoch, &out->mails,
                      &out->seed, &out->rules_left, &len);
    if (read != SNAPSHOT_HEADER_FIELDS || version != 3 || !mu_name_valid(name) ||
        mu_name_reserved(name) || !mu_text_copy(out->name, sizeof out->name, name)) {
        return false;
    }
    *text += len;
    if (!asker_read(text, out)) {
        return false;
    }
    return kind_read(kind, &out->passage.kind) && purpose_read(purpose, &out->purpose) &&
           state_read(state, &out->state);
}

const char *agent_write(struct robot *r, const struct snapshot_header *p, struct mu_text *out,
                        struct mu_fault *fault)
{
    mu_text_clear(out);
    snapshot_header_add(out, p);
    struct mu_text rest = mu_text_in(out->at + out->len, out->size - out->len);
    if (mind_save(r->mind, &rest, fault) != MU_OK) {
        return fault->text;
    }
    out->len += rest.len;
    return NULL;
}
