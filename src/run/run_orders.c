/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the observer says before the first step: robots' groups and services, in their names, and
 * every command that the experiment has, each with its time.
 */
#include "core/pieces.h"
#include "core/text.h"
#include "operator/operator.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- groups and services ---------------------------------------------------------------------- */

/* Reply-with of these mails. */
static const char PAGES_LABEL[] = "pages";

static bool change_send(struct run *r, const char *performative, const char *content)
{
    struct mu_mail mail = {.dst = "broker",
                           .layer = MU_LAYER_QUERY,
                           .performative = performative,
                           .reply_with = PAGES_LABEL,
                           .content = content};
    return mu_agent_send(r->observer, &mail, NULL) == MU_OK;
}

static bool group_tell(struct run *r, const struct experiment_robot *robot, unsigned index)
{
    char content[2 * MU_NAME_MAX + 2];
    snprintf(content, sizeof content, "%s %s", robot->groups[index], robot->name);
    return change_send(r, "group-join", content);
}

static bool service_tell(struct run *r, const struct experiment_robot *robot, unsigned index)
{
    char name[MU_NAME_MAX + 1], content[2 * MU_ATTRIBUTES_MAX + 4 * MU_NAME_MAX];
    const char *service = robot->services[index];
    size_t len = strcspn(service, " ");
    snprintf(name, sizeof name, "%.*s", (int)len, service);
    struct mu_text t = mu_text_in(content, sizeof content);
    change_add_offer(&t, name, service + len + strspn(service + len, " "), 0.0);
    mu_text_format(&t, " %s", robot->name);
    MU_ASSERT(!t.cut);
    return change_send(r, "advertise", content);
}

bool run_pages_tell(struct run *r)
{
    const struct experiment *e = r->experiment;
    uint64_t number = 0; /* of a line, in the order of the file */
    bool room = true;
    for (unsigned i = 0; i < experiment_members(e); i++) {
        const struct experiment_robot *robot = &e->robots[i];
        if (run_pages_own(r, robot)) {
            continue;
        }
        for (unsigned k = 0; k < robot->groups_count; k++, number++) {
            room = room && (number < r->pages_sent || group_tell(r, robot, k));
            r->pages_sent += room && number == r->pages_sent;
        }
        for (unsigned k = 0; k < robot->services_count; k++, number++) {
            room = room && (number < r->pages_sent || service_tell(r, robot, k));
            r->pages_sent += room && number == r->pages_sent;
        }
    }
    return r->pages_answered == number;
}

bool run_pages_take(struct run *r, const struct mu_mail *mail)
{
    if (strcmp(mail->in_reply_to, PAGES_LABEL) != 0 || strcmp(mail->src, "broker") != 0) {
        return false;
    }
    r->pages_answered++;
    if (strcmp(mail->performative, "inform") != 0) {
        fprintf(stderr, "muster run: an agent's group or service is refused: %s\n", mail->content);
        r->command_refused = true;
    }
    return true;
}

/* --- directives ------------------------------------------------------------------------------- */

/* A directive of the experiment's, which is waited for before the first step. */
static mu_result directive_send(struct run *r, struct mu_mail mail)
{
    mail.directive = true;
    mu_result sent = mu_agent_send(r->observer, &mail, NULL);
    r->directives_sent += sent == MU_OK;
    return sent;
}

/* The mail waits for them at the broker. */
void run_wake(struct run *r, const char *child, double due_s)
{
    const struct experiment *e = r->experiment;
    for (unsigned i = 0; i < e->crews_count; i++) {
        const struct experiment_crew *crew = &e->crews[i];
        bool meant = strcmp(e->robots[crew->robot].name, child) == 0;
        for (unsigned k = 0; meant && k < crew->count; k++) {
            struct mu_mail start = {.dst = e->robots[crew->robot + k].name,
                                    .performative = "start",
                                    .timed = due_s >= 0,
                                    .due_ns = due_s >= 0 ? (uint64_t)llround(due_s * 1e9) : 0};
            if (directive_send(r, start) != MU_OK) {
                fprintf(stderr, "muster run: no room for the word to start to %s\n", start.dst);
            }
        }
    }
}

static mu_result pieces_send(struct run *r, const struct mu_mail *piece, const struct mu_text *text)
{
    static char content[MU_CONTENT_MAX + 1];
    struct mu_mail mail = *piece;
    mail.content = content;
    mu_result sent = MU_OK;
    size_t at = 0;
    for (unsigned number = 0; at < text->len && sent == MU_OK; number++) {
        at += mu_pieces_numbered(content, number, text->at, text->len, at);
        sent = directive_send(r, mail);
    }
    return sent;
}

/* What a command launches on its hosts. */
static mu_result launch_tell(struct run *r, unsigned index)
{
    const struct experiment_command *c = &r->experiment->observer[index];
    char label[32], id[MU_NAME_MAX + 32];
    snprintf(label, sizeof label, "%u", index);
    struct mu_text *text = launch_text_begin(c->launch, true, (int64_t)r->experiment->seed);
    mu_result sent = launch_text_rules(text, c->rules);
    for (unsigned t = 0; t < c->targets_count && sent == MU_OK; t++) {
        snprintf(id, sizeof id, "launch-%u-%s", index, c->targets[t]);
        struct mu_mail piece = {.dst = c->targets[t],
                                .performative = "launch",
                                .conversation = id,
                                .reply_with = label,
                                .timed = true,
                                .due_ns = (uint64_t)llround(c->at * 1e9)};
        sent = pieces_send(r, &piece, text);
    }
    return sent;
}

/* @param label  its place in the file, for answers */
static mu_result command_send(struct run *r, const struct experiment_command *c, char *to,
                              const char *label)
{
    return directive_send(r, (struct mu_mail){.dst = to,
                                              .performative = c->move ? "move" : "do",
                                              .reply_with = label,
                                              .content = c->move ? c->move : c->line,
                                              .timed = true,
                                              .due_ns = (uint64_t)llround(c->at * 1e9)});
}

/* One directive to as many of the named robots as fit, and one to each group or address. */
static mu_result command_tell(struct run *r, unsigned index)
{
    const struct experiment_command *c = &r->experiment->observer[index];
    char names[MU_DST_MAX + 1], label[16];
    mu_result sent = MU_OK;
    if (c->launch) {
        return launch_tell(r, index);
    }
    struct mu_text to = mu_text_in(names, sizeof names);
    snprintf(label, sizeof label, "%u", index);
    for (unsigned t = 0; t < c->targets_count && sent == MU_OK; t++) {
        if (receivers_are_many(c->targets[t])) {
            sent = command_send(r, c, c->targets[t], label);
            continue;
        }
        if (to.len + strlen(c->targets[t]) + 1 > MU_DST_MAX) {
            sent = command_send(r, c, names, label);
            mu_text_clear(&to);
        }
        if (sent == MU_OK) {
            mu_text_format(&to, "%s%s", to.len ? "," : "", c->targets[t]);
        }
    }
    return sent == MU_OK && to.len > 0 ? command_send(r, c, names, label) : sent;
}

/* Everything that the observer will ever command goes out before the first step. */
mu_result run_commands_send(struct run *r)
{
    const struct experiment *e = r->experiment;
    struct mu_mail start = {.dst = "robots", .performative = "start", .timed = true};
    mu_result sent = e->robots_count > 0 ? directive_send(r, start) : MU_OK;
    for (unsigned i = 0; sent == MU_OK && i < e->observer_count; i++) {
        sent = command_tell(r, i);
    }
    return sent;
}
