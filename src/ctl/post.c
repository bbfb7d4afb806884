/* SPDX-License-Identifier: Apache-2.0 */
/* muster send, broadcast, do, start, suspend, resume, step: mail and directives. */
#include "core/address.h"
#include "core/exits.h"
#include "core/name.h"
#include "ctl/direct.h"
#include "ctl/envelope.h"
#include "ctl/operator.h"
#include "ctl/receivers.h"
#include "ctl/verbs.h"
#include "ctl/words.h"
#include "desk/desk.h"

#include <stdio.h>
#include <string.h>

/* What one of these verbs sends. */
struct verb {
    const char *name, *usage, *about;
    size_t words_min;
    const char *to; /* NULL: the first word; "group:": the group that it names */
    bool directive;
    const char *performative; /* NULL: --performative */
    const char *example;
    bool counts;        /* the only word behind TARGETS is a number, from 1 on */
    bool changes_state; /* an agent that is away does it when it is back */
    size_t names_max;   /* so many words behind TARGETS, all of them names; 0: any words */
};

static const struct verb VERB_SEND = {"send",
                                      "TO WORD... [OPTION...]",
                                      "Sends a mail.  TO is a name, names joined by commas, "
                                      "all, robots, special, group:G, or SCHEME:REST, an "
                                      "address that somebody resolves, such as role:scout.",
                                      2,
                                      NULL,
                                      false,
                                      NULL,
                                      "muster send red hello world",
                                      false,
                                      false,
                                      0};
static const struct verb VERB_BROADCAST = {"broadcast",
                                           "WORD... [OPTION...]",
                                           "Sends a mail to every agent that is active.",
                                           1,
                                           "all",
                                           false,
                                           NULL,
                                           "muster broadcast hello",
                                           false,
                                           false,
                                           0};
static const struct verb VERB_DO = {"do",
                                    "TARGETS 'LINE' [OPTION...]",
                                    "Makes agents evaluate a CLIPS line; TARGETS as for send, but "
                                    "all leaves hosts out.  Each receiver has a line of its own: "
                                    "its answer, why not, or its silence.",
                                    2,
                                    NULL,
                                    true,
                                    "do",
                                    "muster do red '(wander)'",
                                    false,
                                    false,
                                    0};
static const struct verb VERB_START = {"start",
                                       "TARGETS [OPTION...]",
                                       "Takes agents out of standby.",
                                       1,
                                       NULL,
                                       true,
                                       "start",
                                       "muster start robots",
                                       false,
                                       true,
                                       0};
static const struct verb VERB_SUSPEND = {"suspend",
                                         "TARGETS [OPTION...]",
                                         "Stops agents where they are; their mail waits.",
                                         1,
                                         NULL,
                                         true,
                                         "suspend",
                                         "muster suspend red",
                                         false,
                                         true,
                                         0};
static const struct verb VERB_RESUME = {"resume",
                                        "TARGETS [OPTION...]",
                                        "Lets suspended agents go on.",
                                        1,
                                        NULL,
                                        true,
                                        "resume",
                                        "muster resume red",
                                        false,
                                        true,
                                        0};
static const struct verb VERB_STEP = {"step",
                                      "TARGETS N [OPTION...]",
                                      "Lets robots fire N rules, in as many control steps as that "
                                      "takes, and suspends them then.",
                                      2,
                                      NULL,
                                      true,
                                      "step",
                                      "muster step red 1",
                                      true,
                                      false,
                                      0};
static const struct verb VERB_MOVE = {"move",
                                      "NAME HOST [OPTION...]",
                                      "Moves an agent to another platform, with all that it knows "
                                      "and is about to do.",
                                      2,
                                      NULL,
                                      true,
                                      "move",
                                      "muster move red north",
                                      false,
                                      false,
                                      1};
static const struct verb VERB_CLONE = {"clone",
                                       "NAME NEW [HOST] [OPTION...]",
                                       "Makes a copy of an agent with a name of its own, on a "
                                       "platform, or on its own.",
                                       2,
                                       NULL,
                                       true,
                                       "clone",
                                       "muster clone red ruby north",
                                       false,
                                       false,
                                       2};
static const struct verb VERB_DISPOSE = {"dispose",
                                         "TARGETS [OPTION...]",
                                         "Ends agents for good.",
                                         1,
                                         NULL,
                                         true,
                                         "dispose",
                                         "muster dispose red",
                                         false,
                                         true,
                                         0};
static const struct verb VERB_GROUP_SEND = {"group send",
                                            "GROUP WORD... [OPTION...]",
                                            "Sends a mail to all members of a group; who is absent "
                                            "gets it on coming back.",
                                            2,
                                            "group:",
                                            false,
                                            NULL,
                                            "muster group send scouts hello",
                                            false,
                                            false,
                                            0};

/* @return whether all words behind the first are names, at most so many of them; said if not */
static bool names_check(const struct verb *v, const struct mu_options *o, size_t most)
{
    char shown[MU_TEXT_SHOWN];
    if (o->words_count > 1 + most) {
        fprintf(stderr, "muster %s: expected %s, for example: %s\n", v->name, v->usage, v->example);
        return false;
    }
    for (size_t i = 1; i < o->words_count; i++) {
        if (!mu_name_valid(o->words[i]) || mu_name_reserved(o->words[i])) {
            fprintf(stderr, "muster %s: '%s' cannot be the name of an agent or a host\n", v->name,
                    mu_text_show(shown, o->words[i]));
            return false;
        }
    }
    return true;
}

/* @return whether the words are what the verb takes; said if not */
static bool words_check(const struct verb *v, const struct mu_options *o)
{
    char shown[MU_TEXT_SHOWN];
    char program[32];
    snprintf(program, sizeof program, "muster %s", v->name);
    if (o->words_count < v->words_min || (v->counts && o->words_count > v->words_min)) {
        fprintf(stderr, "%s: expected %s, for example: %s\n", program, v->usage, v->example);
        return false;
    }
    const char *count = o->words[o->words_count - 1];
    size_t digits = strspn(count, "0123456789");
    if (v->counts && (count[digits] || digits > 9 || strspn(count, "0") == digits)) {
        fprintf(stderr, "%s: '%s': expected a number of rules, from 1 to 999999999\n", program,
                mu_text_show(shown, count));
        return false;
    }
    if (v->to && strcmp(v->to, "group:") == 0) {
        return words_group_check(program, o->words[0]);
    }
    if (!v->to && !mu_address_valid(o->words[0])) {
        fprintf(stderr, "%s: '%s': expected " RECEIVERS_EXPECTED "\n", program,
                mu_text_show(shown, o->words[0]));
        return false;
    }
    if (!v->to && strlen(o->words[0]) > MU_DST_MAX) {
        fprintf(stderr, "%s: expected receivers of at most %d bytes\n", program, MU_DST_MAX);
        return false;
    }
    return v->names_max == 0 || names_check(v, o, v->names_max);
}

/* @return whether the content fits a mail; said if not */
static bool content_make(const struct verb *v, const struct mu_options *o, size_t first,
                         char content[MU_CONTENT_MAX + 1])
{
    if (!words_join(content, MU_CONTENT_MAX + 1, o->words + first, o->words_count - first)) {
        fprintf(stderr, "muster %s: expected at most %d bytes of content\n", v->name,
                MU_CONTENT_MAX);
        return false;
    }
    if (!words_are_utf8(content)) {
        fprintf(stderr, "muster %s: expected content in UTF-8\n", v->name);
        return false;
    }
    return true;
}

/* Who answers is no agent that anybody knows: it speaks for one on its way. */
static void answer_show(void *self, const struct mu_mail *mail)
{
    (void)self;
    bool done = strcmp(mail->performative, "inform") == 0;
    const char *advice = done ? NULL : answer_travel_advice(mail->content);
    if (strcmp(mail->performative, "not-understood") == 0) {
        answer_print(mail, false);
    } else if (advice) {
        fprintf(stderr, "muster: %s: %s\n", mail->content, advice);
    } else {
        fputs(done ? "" : "muster: ", stderr);
        answer_content_print(done ? stdout : stderr, mail->content);
    }
}

static int verb_send(const struct verb *v, const struct mu_options *o,
                     struct operator_options *options, const struct envelope *envelope)
{
    static char content[MU_CONTENT_MAX + 1];
    char to[MU_DST_MAX + 1];
    bool to_all = v->to && strcmp(v->to, "all") == 0;
    snprintf(to, sizeof to, "%s%s", v->to ? v->to : "", to_all ? "" : o->words[0]);
    struct mu_mail mail = {
        .dst = to, .directive = v->directive, .performative = v->performative, .content = content};
    if (!content_make(v, o, to_all ? 0 : 1, content) ||
        (!v->directive && !envelope_fill(envelope, &mail, v->name))) {
        return MU_EXIT_USAGE;
    }
    bool travels = v == &VERB_MOVE || v == &VERB_CLONE;
    bool asks = v->directive || options->wait_s > 0.0;
    bool each = v->directive && !travels && direct_is_possible(to);
    options->takes_no_mail = !asks;
    if (each) {
        direct_hear(options);
    }
    struct operator op;
    int code = operator_join(&op, options, v->name);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    double wait_s = options->wait_s > 0.0 ? options->wait_s : travels ? 25.0 : 5.0;
    if (travels && !op.json) {
        op.on_answer = answer_show;
    }
    code = v == &VERB_DO ? operator_look(&op, to, content, wait_s) : -1;
    if (code < 0 && each) {
        struct direct direct = {to, v->performative, content, wait_s, v->changes_state};
        code = direct_send(&op, &direct);
    } else if (code < 0) {
        unsigned wanted =
            asks ? receivers_count(op.process, to, mu_agent_name(op.agent), v->directive) : 0;
        code = operator_send(&op, &mail, wanted, wait_s);
    }
    operator_leave(&op);
    return code;
}

static int verb_run(const struct verb *v, int argc, char **argv)
{
    static struct operator_options options;
    static struct envelope envelope;
    char program[32];
    snprintf(program, sizeof program, "muster %s", v->name);
    struct mu_option table[] = {
        OPERATOR_OPTIONS(options),
        {.name = "json",
         .kind = MU_OPTION_FLAG,
         .help = "answers, or what became of the mail, as objects, one a line",
         .target = &options.json},
        {.name = "quiet",
         .letter = 'q',
         .kind = MU_OPTION_FLAG,
         .help = "do not say what became of the mail when all is well",
         .target = &options.quiet},
        {.name = "wait",
         .kind = MU_OPTION_REAL,
         .unit = "S",
         .max = 1e6,
         .help = "wait so long for an answer and print it",
         .target = &options.wait_s},
        ENVELOPE_OPTIONS(envelope),
    };
    /* A directive has no envelope of its own. */
    size_t count = sizeof table / sizeof table[0] - (v->directive ? ENVELOPE_ROWS : 0);
    static struct mu_options o;
    o = (struct mu_options){
        .program = program, .usage = v->usage, .about = v->about, .table = table, .count = count};
    mu_result parsed = operator_parse(&o, argc, argv, &options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    return words_check(v, &o) ? verb_send(v, &o, &options, &envelope) : MU_EXIT_USAGE;
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

int post_verb_step(int argc, char **argv)
{
    return verb_run(&VERB_STEP, argc, argv);
}

int post_verb_move(int argc, char **argv)
{
    return verb_run(&VERB_MOVE, argc, argv);
}

int post_verb_clone(int argc, char **argv)
{
    return verb_run(&VERB_CLONE, argc, argv);
}

int post_verb_dispose(int argc, char **argv)
{
    return verb_run(&VERB_DISPOSE, argc, argv);
}

int post_verb_group_send(int argc, char **argv)
{
    return verb_run(&VERB_GROUP_SEND, argc, argv);
}
