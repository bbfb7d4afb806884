/* SPDX-License-Identifier: Apache-2.0 */
/* muster send, broadcast, do, start, suspend, resume: mail and directives from the command line. */
#include "core/exits.h"
#include "core/name.h"
#include "ctl/operator.h"
#include "ctl/verbs.h"

#include <stdio.h>
#include <string.h>

/* What one of these verbs sends. */
struct verb {
    const char *name, *usage, *about;
    size_t words_min;
    const char *to; /* NULL: the first word */
    bool directive;
    const char *performative; /* NULL: --performative */
    const char *example;
};

static const struct verb VERB_SEND = {"send",
                                      "TO WORD... [OPTION...]",
                                      "Sends a mail; TO is a name, names joined by commas, all, "
                                      "robots, special, group:G, or an address such as role:R.",
                                      2,
                                      NULL,
                                      false,
                                      NULL,
                                      "muster send red hello world"};
static const struct verb VERB_BROADCAST = {"broadcast",
                                           "WORD... [OPTION...]",
                                           "Sends a mail to every agent that is active.",
                                           1,
                                           "all",
                                           false,
                                           NULL,
                                           "muster broadcast hello"};
static const struct verb VERB_DO = {"do",
                                    "TARGETS 'LINE' [OPTION...]",
                                    "Makes agents evaluate a CLIPS line; TARGETS as for send.",
                                    2,
                                    NULL,
                                    true,
                                    "do",
                                    "muster do red '(wander)'"};
static const struct verb VERB_START = {
    "start", "TARGETS [OPTION...]", "Takes agents out of standby.", 1, NULL, true,
    "start", "muster start robots"};
static const struct verb VERB_SUSPEND = {"suspend",
                                         "TARGETS [OPTION...]",
                                         "Stops agents where they are; their mail waits.",
                                         1,
                                         NULL,
                                         true,
                                         "suspend",
                                         "muster suspend red"};
static const struct verb VERB_RESUME = {
    "resume", "TARGETS [OPTION...]", "Lets suspended agents go on.", 1, NULL, true,
    "resume", "muster resume red"};

/* How many answers a directive to these receivers brings; of all, robots are sure to answer. */
static unsigned answers_of(const struct operator* op, const char *to)
{
    unsigned count = 1;
    for (const char *c = to; *c; c++) {
        count += *c == ',';
    }
    if (strcmp(to, "special") == 0) {
        return 0; /* none of them need know CLIPS */
    }
    if (strcmp(to, "all") != 0 && strcmp(to, "robots") != 0) {
        return count;
    }
    const struct mu_member *m;
    count = 0;
    for (size_t i = 0; (m = mu_process_member(op->process, i)); i++) {
        count += m->kind == MU_KIND_ROBOT && m->state != MU_GONE;
    }
    return count;
}

static bool receivers_valid(const char *to)
{
    char name[MU_NAME_MAX + 2];
    const char *colon = strchr(to, ':');
    if (colon) { /* group:G, or another address that somebody resolves: the broker knows */
        snprintf(name, sizeof name, "%.*s", (int)(colon - to), to);
        return colon - to <= MU_NAME_MAX && mu_name_valid(name) && colon[1] != '\0';
    }
    for (size_t len; *to; to += len + (to[len] == ',')) {
        len = strcspn(to, ",");
        snprintf(name, sizeof name, "%.*s", (int)(len < sizeof name ? len : sizeof name), to);
        if (!mu_name_valid(name)) {
            return false;
        }
    }
    return true;
}

static int verb_send(const struct verb *v, const struct mu_options *o,
                     const struct operator_options *options, const char *performative)
{
    static char content[MU_CONTENT_MAX + 1];
    size_t first = v->to ? 0 : 1;
    if (!operator_words(content, sizeof content, o->words + first, o->words_count - first)) {
        fprintf(stderr, "muster %s: more than %d bytes\n", v->name, MU_CONTENT_MAX);
        return MU_EXIT_USAGE;
    }
    if (!v->to && !receivers_valid(o->words[0])) {
        fprintf(stderr,
                "muster %s: '%s': expected a name, names joined by commas, all, robots, special "
                "or group:G\n",
                v->name, o->words[0]);
        return MU_EXIT_USAGE;
    }
    struct operator op;
    int code = operator_join(&op, options, v->name);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    struct mu_mail mail = {.dst = v->to ? v->to : o->words[0],
                           .directive = v->directive,
                           .performative = v->performative ? v->performative : performative,
                           .content = content};
    bool asks = v == &VERB_DO || options->wait_s > 0.0;
    double wait_s = options->wait_s > 0.0 ? options->wait_s : 5.0;
    code = operator_send(&op, &mail, asks ? answers_of(&op, mail.dst) : 0, wait_s);
    operator_leave(&op);
    return code;
}

static int verb_run(const struct verb *v, int argc, char **argv)
{
    static struct operator_options options;
    const char *performative = NULL;
    char program[32];
    snprintf(program, sizeof program, "muster %s", v->name);
    struct mu_option table[] = {
        OPERATOR_OPTIONS(options),
        {.name = "wait",
         .kind = MU_OPTION_REAL,
         .unit = "S",
         .max = 1e6,
         .help = "wait so long for an answer and print it",
         .target = &options.wait_s},
        {.name = "performative",
         .kind = MU_OPTION_STRING,
         .unit = "P",
         .help = "the speech act, for example ask-one",
         .target = &performative},
    };
    /* A directive's performative is the verb itself. */
    size_t count = sizeof table / sizeof table[0] - (v->performative ? 1 : 0);
    static struct mu_options o;
    o = (struct mu_options){
        .program = program, .usage = v->usage, .about = v->about, .table = table, .count = count};
    mu_result parsed = operator_parse(&o, argc, argv, &options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (o.words_count < v->words_min) {
        fprintf(stderr, "muster %s: expected %s, for example: %s\n", v->name, v->usage, v->example);
        return MU_EXIT_USAGE;
    }
    return verb_send(v, &o, &options, performative);
}

int post_verb_send(int argc, char **argv)
{
    return verb_run(&VERB_SEND, argc, argv);
}

int post_verb_broadcast(int argc, char **argv)
{
    return verb_run(&VERB_BROADCAST, argc, argv);
}

int post_verb_do(int argc, char **argv)
{
    return verb_run(&VERB_DO, argc, argv);
}

int post_verb_start(int argc, char **argv)
{
    return verb_run(&VERB_START, argc, argv);
}

int post_verb_suspend(int argc, char **argv)
{
    return verb_run(&VERB_SUSPEND, argc, argv);
}

int post_verb_resume(int argc, char **argv)
{
    return verb_run(&VERB_RESUME, argc, argv);
}
