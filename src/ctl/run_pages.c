/* SPDX-License-Identifier: Apache-2.0 */
/* Groups and services of an experiment's robots: the observer enters them in the robots' names. */
#include "core/text.h"
#include "ctl/change.h"
#include "ctl/run.h"

#include <stdio.h>
#include <string.h>

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
    struct mu_text t;
    snprintf(name, sizeof name, "%.*s", (int)len, service);
    mu_text_init(&t, content, sizeof content);
    change_add_offer(&t, name, service + len + strspn(service + len, " "), 0.0);
    mu_text_format(&t, " %s", robot->name);
    MU_ASSERT(!t.cut);
    return change_send(r, "advertise", content);
}

bool run_pages_own(const struct run *r, const struct experiment_robot *robot)
{
    return robot->broker && strcmp(robot->broker, run_broker(r, 0)) != 0;
}

bool run_pages_tell(struct run *r)
{
    const struct experiment *e = r->experiment;
    uint64_t number = 0; /* of a line, in the order of the file */
    bool room = true;
    for (unsigned i = 0; i < e->robots_count; i++) {
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
        fprintf(stderr, "muster run: a robot's group or service is refused: %s\n", mail->content);
        r->command_refused = true;
    }
    return true;
}
