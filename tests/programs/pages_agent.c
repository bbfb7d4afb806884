/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A member of the group `scouts` that looks out for mappers and writes a line for all that it
 * hears. pages_agent DOMAIN NAME RECORD [ATTRIBUTES|- [BROKER]] With ATTRIBUTES it is a mapper
 * itself.  What it is told, it tells the group; when it is told "create", it tries to make the
 * group once more.
 */
#include "record.h"

#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int record;

static void check(mu_result sent)
{
    if (sent != MU_OK) {
        record_line(record, "not sent: %s", mu_result_text(sent));
    }
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    record_line(record, "mail %s %s", mail->src, mail->content);
    if (strcmp(mail->dst, mu_agent_name(a)) != 0) {
        return;
    }
    if (strcmp(mail->content, "create") == 0) {
        check(mu_agent_group_create(a, "scouts"));
    } else {
        check(mu_agent_group_send(a, "scouts", mail->content));
    }
}

static void on_refusal(void *self, mu_agent *a, const char *change, const char *reason)
{
    (void)self;
    (void)a;
    record_line(record, "refused %s %s", change, reason);
}

static void on_service(void *self, mu_agent *a, const struct mu_service *service, bool came)
{
    mu_process *p = *(mu_process **)self;
    (void)a;
    record_line(record, "%s %s %s [%s] found %s", came ? "came" : "went", service->service,
                service->agent, service->attributes,
                mu_process_find_service(p, "mapper", 0) ? "some" : "none");
}

/* Writes the members of the group whenever they have changed. */
static void members_note(const mu_process *p)
{
    static char last[256];
    char now[256] = "";
    const char *name;
    for (size_t i = 0; (name = mu_process_group_member(p, "scouts", i)); i++) {
        size_t len = strlen(now);
        snprintf(now + len, sizeof now - len, " %s", name);
    }
    if (strcmp(now, last) != 0) {
        snprintf(last, sizeof last, "%s", now);
        record_line(record, "members%s", now);
    }
}

int main(int argc, char **argv)
{
    if (argc < 4) {
        return 2;
    }
    mu_process *p;
    mu_agent *a;
    record = record_open(argv[3]);
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10),
                                         .broker = argc > 5 ? argv[5] : NULL};
    struct mu_handlers handlers = {
        .self = &p, .on_mail = on_mail, .on_refusal = on_refusal, .on_service = on_service};
    if (record < 0 || mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, argv[2], MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        return 4;
    }
    check(mu_agent_group_join(a, "scouts"));
    if (argc > 4 && strcmp(argv[4], "-") != 0) {
        check(mu_agent_advertise(a, "mapper", argv[4], 0));
    } else {
        check(mu_agent_watch_service(a, "mapper role=scout near=0,0,5"));
    }
    while (mu_process_spin(p, 20000000) == MU_OK) {
        members_note(p);
    }
    return 0;
}
