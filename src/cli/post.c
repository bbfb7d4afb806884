/* SPDX-License-Identifier: Apache-2.0 */
/* muster send, broadcast, do, start, suspend, resume, step: mail and directives. */
#include "cli/verbs.h"
#include "core/address.h"
#include "core/exits.h"
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>

enum {
    DIRECTIVE = 1, /* its performative is the verb's name; others have that of --performative */
    COUNTS = 2,    /* the last word is a number, from 1 on */
    MAY_WAIT = 4,  /* an agent that is away does it when it is back */
    TRAVELS = 8,   /* the words behind the first are names */
    LOOKS = 16     /* its line may be one that only looks */
};

/* What one of these verbs sends. */
static const struct verb {
    const char *name, *usage, *example, *about;
    size_t words_min, words_max; /* 0: any */
    unsigned is;
    const char *to; /* NULL: the first word; "group:": the group that it names */
} verbs[] = {
    {"send", "TO WORD... [OPTION...]", "muster send red hello world",
     "Sends a mail.  TO is a name, names joined by commas, all, robots, special, group:G, or "
     "SCHEME:REST, an address that a resolver knows, such as role:scout.",
     2, 0, 0, NULL},
    {"broadcast", "WORD... [OPTION...]", "muster broadcast hello",
     "Sends a mail to every agent that is active.", 1, 0, 0, "all"},
    {"do", "TARGETS 'LINE' [OPTION...]", "muster do red '(wander)'",
     "Makes agents evaluate a CLIPS line; TARGETS as for send, but all leaves hosts out.  Each "
     "receiver has a line of its own: its answer, why not, or its silence.",
     2, 0, DIRECTIVE | LOOKS, NULL},
    {"start", "TARGETS [OPTION...]", "muster start red,blue", "Takes agents out of standby.", 1, 1,
     DIRECTIVE | MAY_WAIT, NULL},
    {"suspend", "TARGETS [OPTION...]", "muster suspend red,blue",
     "Stops agents where they are; their mail waits.", 1, 1, DIRECTIVE | MAY_WAIT, NULL},
    {"resume", "TARGETS [OPTION...]", "muster resume red,blue", "Lets suspended agents go on.", 1,
     1, DIRECTIVE | MAY_WAIT, NULL},
    {"step", "TARGETS N [OPTION...]", "muster step red 1",
     "Lets robots fire N rules, in as many control steps as that takes, and suspends them then.", 2,
     2, DIRECTIVE | COUNTS, NULL},
    {"move", "NAME HOST [OPTION...]", "muster move red north",
     "Moves an agent to another platform, with all that it knows and is about to do.", 2, 2,
     DIRECTIVE | TRAVELS, NULL},
    {"clone", "NAME NEW [HOST] [OPTION...]", "muster clone red ruby north",
     "Makes a copy of an agent with a name of its own, on a platform, or on its own.", 2, 3,
     DIRECTIVE | TRAVELS, NULL},
    {"dispose", "TARGETS [OPTION...]", "muster dispose red,blue", "Ends agents for good.", 1, 1,
     DIRECTIVE | MAY_WAIT, NULL},
    {"group send", "GROUP WORD... [OPTION...]", "muster group send scouts hello",
     "Sends a mail to all members of a group; an absent one gets it on coming back.", 2, 0, 0,
     "group:"},
};

/* @return whether the words are what the verb takes; said if not */
static bool words_check(const struct verb *v, const struct mu_options *o)
{
    char shown[MU_TEXT_SHOWN];
    char program[32];
    snprintf(program, sizeof program, "muster %s", v->name);
    if (o->words_count < v->words_min || (v->words_max && o->words_count > v->words_max)) {
        fprintf(stderr, "%s: expected %s, for example: %s\n", program, v->usage, v->example);
        return false;
    }
    const char *count = o->words[o->words_count - 1];
    size_t digits = strspn(count, "0123456789");
    if ((v->is & COUNTS) && (count[digits] || digits > 9 || strspn(count, "0") == digits)) {
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
    bool good = true;
    for (size_t i = 1; (v->is & TRAVELS) && i < o->words_count && good; i++) {
        good = words_place_check(program, o->words[i]);
    }
    return good;
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

/* The answer comes from no agent with a name: it speaks for one that migrates. */
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
    bool directive = v->is & DIRECTIVE, travels = v->is & TRAVELS;
    bool to_all = v->to && strcmp(v->to, "all") == 0;
    snprintf(to, sizeof to, "%s%s", v->to ? v->to : "", to_all ? "" : o->words[0]);
    struct mu_mail mail = {.dst = to,
                           .directive = directive,
                           .performative = directive ? v->name : NULL,
                           .content = content};
    if (!content_make(v, o, to_all ? 0 : 1, content) ||
        (!directive && !envelope_fill(envelope, &mail, v->name))) {
        return MU_EXIT_USAGE;
    }
    bool asks = directive || options->wait_s > 0.0;
    bool each = directive && !travels && direct_is_possible(to);
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
    code = v->is & LOOKS ? operator_look(&op, to, content, wait_s) : -1;
    if (code < 0 && each) {
        struct direct direct = {to, v->name, content, wait_s, v->is & MAY_WAIT};
        code = direct_send(&op, &direct);
    } else if (code < 0) {
        unsigned wanted =
            asks ? receivers_count(op.process, to, mu_agent_name(op.agent), directive) : 0;
        code = operator_send(&op, &mail, wanted, wait_s);
    }
    operator_leave(&op);
    return code;
}

int post_verb(int argc, char **argv)
{
    const struct verb *v = verbs;
    while (strcmp(v->name, argv[0]) != 0) {
        v++;
    }
    static struct operator_options options;
    static struct envelope envelope;
    char program[32];
    snprintf(program, sizeof program, "muster %s", v->name);
    struct mu_option table[] = {
        OPERATOR_OPTIONS(options),
        MU_FLAG("json", options.json,
                "answers, or what became of the mail, as objects, one a line"),
        MU_FLAG("quiet", options.quiet, "do not say what became of the mail when all is well",
                .letter = 'q'),
        MU_REAL("wait", "S", options.wait_s, "wait so long for an answer and print it", .max = 1e6),
        ENVELOPE_OPTIONS(envelope),
    };
    /* A directive has no envelope of its own. */
    size_t count = sizeof table / sizeof table[0] - (v->is & DIRECTIVE ? ENVELOPE_ROWS : 0);
    static struct mu_options o;
    o = (struct mu_options){
        .program = program, .usage = v->usage, .about = v->about, .table = table, .count = count};
    mu_result parsed = operator_parse(&o, argc, argv, &options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    return words_check(v, &o) ? verb_send(v, &o, &options, &envelope) : MU_EXIT_USAGE;
}
