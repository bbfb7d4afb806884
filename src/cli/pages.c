/* SPDX-License-Identifier: Apache-2.0 */
/* muster ps, muster lookup: the white pages. */
#include "cli/verbs.h"
#include "core/exits.h"
#include "core/json.h"
#include "operator/operator.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/* A part of the broker that does not answer within this has gone with its broker. */
static const double ANSWER_PATIENCE_S = 5.0;

static void since_text(uint64_t wall_ns, char *text, size_t size)
{
    time_t seconds = (time_t)(wall_ns / 1000000000u);
    struct tm utc;
    gmtime_r(&seconds, &utc);
    strftime(text, size, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

/* What a part of the broker answers when it is asked for its state: "PART NAME NUMBER ..." */
struct counters {
    char text[MU_CONTENT_MAX + 1];
    const char *at; /* after the part's name; NULL: there is no answer */
};

static void counters_take(void *self, const struct mu_mail *mail)
{
    struct counters *c = self;
    if (strcmp(mail->performative, "inform") == 0) {
        snprintf(c->text, sizeof c->text, "%s", mail->content);
        c->at = c->text + strcspn(c->text, " ");
    }
}

/* Takes the next counter.  @return false at the end */
static bool counter_next(struct counters *c, char name[MU_FIELD_MAX + 1], uint64_t *value)
{
    int len = 0;
    unsigned long long number;
    if (!c->at || sscanf(c->at, " %63s %llu%n", name, &number, &len) != 2) {
        return false;
    }
    c->at += len;
    *value = number;
    return true;
}

static bool is_part(const struct mu_member *m)
{
    return m->kind == MU_KIND_SPECIAL &&
           (strcmp(m->name, "broker") == 0 || strncmp(m->name, "broker.", 7) == 0);
}

/* @return the exit code */
static int counters_ask(struct operator* op, const struct mu_member *m, struct counters *c)
{
    struct mu_mail question = {.layer = MU_LAYER_QUERY, .performative = "state", .content = ""};
    char name[MU_NAME_MAX + 1];
    snprintf(name, sizeof name, "%s", m->name);
    question.dst = name;
    op->on_answer = counters_take;
    op->on_answer_self = c;
    return operator_send(op, &question, 1, ANSWER_PATIENCE_S);
}

static void counters_print(struct counters *c)
{
    char name[MU_FIELD_MAX + 1];
    uint64_t value;
    while (counter_next(c, name, &value)) {
        printf("  %-28s %" PRIu64 "\n", name, value);
    }
}

static void counters_print_json(struct counters *c, struct mu_json *j)
{
    char name[MU_FIELD_MAX + 1];
    uint64_t value;
    mu_json_object(j, "counters");
    while (counter_next(c, name, &value)) {
        mu_json_uint(j, name, value);
    }
    mu_json_end(j);
}

/* counters: of a part of the broker; NULL: none are wanted */
static void member_print(const struct mu_member *m, bool json, struct counters *counters)
{
    char since[32];
    since_text(m->since_wall_ns, since, sizeof since);
    if (!json) {
        printf("%-20s %-8s %-10s %-10s %-16s %8u  %s%s%s\n", m->name, mu_kind_text(m->kind),
               mu_state_text(m->state), m->broker, m->host, m->pid, since, m->reason[0] ? "  " : "",
               m->reason);
        if (counters) {
            counters_print(counters);
        }
        return;
    }
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "name", m->name);
    mu_json_string(&j, "kind", mu_kind_text(m->kind));
    mu_json_string(&j, "state", mu_state_text(m->state));
    mu_json_string(&j, "broker", m->broker);
    mu_json_string(&j, "host", m->host);
    mu_json_uint(&j, "pid", m->pid);
    mu_json_string(&j, "since", since);
    if (m->reason[0]) {
        mu_json_string(&j, "reason", m->reason);
    }
    if (counters && counters->at) {
        counters_print_json(counters, &j);
    }
    mu_json_end(&j);
}

static void head_print(bool json)
{
    if (!json) {
        printf("%-20s %-8s %-10s %-10s %-16s %8s  %s\n", "NAME", "KIND", "STATE", "BROKER", "HOST",
               "PID", "SINCE");
    }
}

static struct operator_options options = {.only_reads = true};

static struct mu_option option_table[] = {OPERATOR_OPTIONS(options),
                                          MU_FLAG("json", options.json, "one object a line")};

int pages_verb_ps(int argc, char **argv)
{
    static struct mu_options o = {.program = "muster ps",
                                  .usage = "[OPTION...]",
                                  .about = "Lists the white pages: every agent and its state.",
                                  MU_OPTION_TABLE(option_table),
                                  .no_words = true};
    mu_result parsed = operator_parse(&o, argc, argv, &options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    struct operator op;
    int code = operator_join(&op, &options, "ps");
    if (code != MU_EXIT_DONE) {
        return code;
    }
    head_print(options.json);
    const struct mu_member *m;
    for (size_t i = 0; (m = mu_process_member(op.process, i)); i++) {
        if (!reader_is(m)) {
            member_print(m, options.json, NULL);
        }
    }
    operator_leave(&op);
    return MU_EXIT_DONE;
}

int pages_verb_lookup(int argc, char **argv)
{
    static struct mu_options o = {.program = "muster lookup",
                                  .usage = "NAME [OPTION...]",
                                  .about =
                                      "Looks one agent up in the white pages; of a part of the "
                                      "broker, what it has counted, too.",
                                  MU_OPTION_TABLE(option_table),
                                  .one = "agent",
                                  .example = "red"};
    mu_result parsed = operator_parse(&o, argc, argv, &options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (!words_name_check("muster lookup", "an agent", o.words[0])) {
        return MU_EXIT_USAGE;
    }
    struct operator op;
    int code = operator_join(&op, &options, "lookup");
    if (code != MU_EXIT_DONE) {
        return code;
    }
    static struct counters counters;
    const struct mu_member *m = mu_process_lookup(op.process, o.words[0]);
    code = m ? MU_EXIT_DONE : MU_EXIT_NO_AGENT;
    if (m && is_part(m)) {
        code = counters_ask(&op, m, &counters);
        m = mu_process_lookup(op.process, o.words[0]);
    }
    if (m) {
        head_print(options.json);
        member_print(m, options.json, &counters);
    } else {
        fprintf(stderr, "muster lookup: no agent named %s; muster ps lists them\n", o.words[0]);
    }
    operator_leave(&op);
    return code;
}
