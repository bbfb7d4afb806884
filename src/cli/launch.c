/* SPDX-License-Identifier: Apache-2.0 */
/* muster launch: a new agent on a running host, which gets the rules in pieces. */
#include "cli/verbs.h"
#include "core/exits.h"
#include "core/name.h"
#include "core/pieces.h"
#include "core/text.h"
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double ANSWER_PATIENCE_S = 15.0;

struct launch {
    struct operator_options options;
    const char *name, *host, *rules;
    int64_t seed;
    bool start;
    struct mu_option_list globals, groups;
};

static int pieces_send(struct operator* op, const struct launch *l, const struct mu_text *text)
{
    static char content[MU_CONTENT_MAX + 1];
    char id[64];
    int code = MU_EXIT_DONE;
    size_t at = 0;
    snprintf(id, sizeof id, "launch-%ld", (long)getpid());
    for (unsigned piece = 0; at < text->len && code == MU_EXIT_DONE; piece++) {
        at += mu_pieces_numbered(content, piece, text->at, text->len, at);
        bool last = at == text->len;
        op->quiet = !last || l->options.quiet;
        struct mu_mail mail = {.dst = l->host,
                               .directive = true,
                               .performative = "launch",
                               .conversation = id,
                               .reply_with = id,
                               .content = content};
        code = operator_send(op, &mail, last ? 1 : 0, ANSWER_PATIENCE_S);
    }
    return code;
}

static int launch(struct launch *l)
{
    struct mu_text *text = launch_text_begin(l->name, l->start, l->seed);
    for (size_t i = 0; i < l->globals.count; i++) {
        mu_text_format(text, "global %s\n", l->globals.items[i]);
    }
    for (size_t i = 0; i < l->groups.count; i++) {
        mu_text_format(text, "group %s\n", l->groups.items[i]);
    }
    if (launch_text_rules(text, l->rules) != MU_OK) {
        return MU_EXIT_FILE;
    }
    struct operator op;
    int code = operator_join(&op, &l->options, "launch");
    if (code != MU_EXIT_DONE) {
        return code;
    }
    code = pieces_send(&op, l, text);
    operator_leave(&op);
    return code;
}

static bool words_take(const struct mu_options *o, struct launch *l)
{
    if (o->words_count != 2 || !l->rules) {
        fprintf(stderr, "muster launch: expected NAME HOST --rules FILE, for example: "
                        "muster launch red north --rules rules/follower.clp\n");
        return false;
    }
    l->name = o->words[0];
    l->host = o->words[1];
    return words_place_check("muster launch", l->name) &&
           words_place_check("muster launch", l->host);
}

/* What stands in a line of its own. */
static bool line_fits(const char *line)
{
    return strlen(line) <= MU_FIELD_MAX && !strpbrk(line, "\r\n") && words_are_utf8(line);
}

static bool pages_check(const struct launch *l)
{
    char shown[MU_TEXT_SHOWN];
    size_t bytes = 0;
    for (size_t i = 0; i < l->globals.count; i++) {
        const char *global = l->globals.items[i];
        bytes += strlen(global) + sizeof "global ";
        if (!line_fits(global) || !strchr(global, '=') || global[0] == '=') {
            fprintf(stderr, "muster launch --global %s: expected NAME=VALUE, at most %d bytes\n",
                    mu_text_show(shown, global), MU_FIELD_MAX);
            return false;
        }
    }
    for (size_t i = 0; i < l->groups.count; i++) {
        bytes += strlen(l->groups.items[i]) + sizeof "group ";
        if (!mu_name_of_group(l->groups.items[i])) {
            fprintf(stderr, "muster launch --group %s: this cannot be the name of a group\n",
                    mu_text_show(shown, l->groups.items[i]));
            return false;
        }
    }
    if (bytes > LAUNCH_HEAD_MAX - 256) {
        fprintf(stderr, "muster launch: globals and groups have more than %d bytes\n",
                LAUNCH_HEAD_MAX - 256);
        return false;
    }
    return true;
}

int launch_verb(int argc, char **argv)
{
    static struct launch l;
    static struct mu_options o;
    struct mu_option table[] = {
        OPERATOR_OPTIONS(l.options),
        MU_STRING("rules", "FILE", l.rules,
                  "the agent's behaviour, a CLIPS file; files beside it that it extends go along",
                  .letter = 'r'),
        MU_INTEGER("seed", "N", l.seed, "seed of (random), together with the name",
                   .fallback = "1"),
        MU_LIST("global", "NAME=VALUE", l.globals, "set a global, for example mate=red"),
        MU_NAMES("group", "G", l.groups,
                 "join groups, with commas, when the broker knows the agent"),
        MU_FLAG("start", l.start, "let it run at once, without waiting in standby"),
        MU_FLAG("json", l.options.json, "the answer as an object"),
        MU_FLAG("quiet", l.options.quiet, "do not say what became of the mail when all is well",
                .letter = 'q'),
    };
    o = (struct mu_options){.program = "muster launch",
                            .usage = "NAME HOST --rules FILE [OPTION...]",
                            .about = "Begins a new agent on a running host.",
                            MU_OPTION_TABLE(table)};
    mu_result parsed = operator_parse(&o, argc, argv, &l.options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    return words_take(&o, &l) && pages_check(&l) ? launch(&l) : MU_EXIT_USAGE;
}
