/* SPDX-License-Identifier: Apache-2.0 */
/* Mail, questions and directives to a robot. */
#include "agent/robot.h"
#include "core/log.h"
#include "core/name.h"
#include "muster/refusal.h"
#include "runtime/kind.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Tells the sender, if it wrote to this robot alone, that the mind's queue is full. */
static void mail_refuse(struct robot *r, const struct mu_mail *refused)
{
    if (!r->box_full) {
        mu_log(MU_LOG_WARNING, "box-full", "name=%s from=%s: the rules take no mail",
               mu_agent_name(r->agent), refused->src);
        r->box_full = true;
    }
    /* no failure for a failure: two full queues would answer each other for ever */
    if (strcmp(refused->dst, mu_agent_name(r->agent)) != 0 ||
        strcmp(refused->performative, "failure") == 0) {
        return;
    }
    struct mu_mail mail = {.dst = refused->src,
                           .layer = refused->layer,
                           .performative = "failure",
                           .in_reply_to = refused->reply_with,
                           .conversation = refused->conversation,
                           .content = "box-full"};
    if (mu_agent_send(r->agent, &mail, NULL) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", refused->src);
    }
}

/* Makes a mail for the mind.  Its rules count from 1; a box counts across lives of a broker. */
static struct mind_mail letter_of(const struct mu_mail *mail, uint64_t id)
{
    return (struct mind_mail){.id = id,
                              .src = mail->src,
                              .performative = mail->performative,
                              .language = mail->language,
                              .ontology = mail->ontology,
                              .reply_with = mail->reply_with,
                              .in_reply_to = mail->in_reply_to,
                              .conversation = mail->conversation,
                              .content = mail->content,
                              .reply_by_ns = mail->reply_by_ns,
                              .layer = mail->layer};
}

/* Rules that claim a layer come before the robot's own behaviour. */
enum mu_take mail_take_by_rules(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct robot *r = self;
    percept_settle(r);
    r->numbered = mind_has_layer(r->mind, mail->layer);
    if (!r->numbered) {
        return MU_PASS;
    }
    struct mind_mail letter = letter_of(mail, ++r->mails);
    return mind_handle(r->mind, &letter) ? MU_TAKEN : MU_PASS;
}

/* Takes mail that no kind took.  Rules were asked for layers 1 to 3, but not for higher ones. */
void mail_on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    struct robot *r = self;
    percept_settle(r);
    if (mail->layer > MU_LAYER_SPEECH && mail_take_by_rules(self, a, mail) != MU_PASS) {
        return;
    }
    struct mind_mail letter = letter_of(mail, r->mails);
    if (!mind_understands(r->mind, &letter)) {
        kind_not_understood(a, mail);
        return;
    }
    letter.id = r->numbered ? r->mails : ++r->mails;
    if (mind_take_mail(r->mind, &letter) == MU_FULL) {
        mail_refuse(r, mail);
    }
}

/* Answers the sender with the output of a line, as one CLIPS string. */
static void line_answer(struct robot *r, const struct mu_mail *asked, bool done)
{
    struct mu_text quoted = mu_text_in(r->group->quoted, sizeof r->group->quoted);
    mu_text_add(&quoted, "\"");
    for (const char *c = r->group->answer; *c && quoted.len < sizeof r->group->quoted - 3; c++) {
        if (*c == '"' || *c == '\\') {
            mu_text_add(&quoted, "\\");
        }
        mu_text_add_bytes(&quoted, c, 1);
    }
    mu_text_add(&quoted, "\"");
    if (mu_agent_reply(r->agent, asked, done ? "inform" : "failure", r->group->quoted) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", asked->src);
    }
}

/* Answers with all facts, or those of the relation that the content names. */
enum mu_take mail_take_facts(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct robot *r = self;
    percept_settle(r);
    struct mu_text answer = mu_text_in(r->group->answer, sizeof r->group->answer);
    bool done = mind_facts(r->mind, mail->content, &answer) == MU_OK;
    line_answer(r, mail, done);
    return MU_TAKEN;
}

/* Stands for mind_line when a line is set aside. */
static mu_result line_set_aside(struct mind *m, const char *line, struct mu_text *out)
{
    (void)m;
    (void)line;
    mu_text_format(out,
                   "set aside: the agent has died of it %d times; (set-aside) lists such lines\n",
                   ASIDE_LIVES);
    return MU_MALFORMED;
}

static void directive_do(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    bool is_console = strcmp(mail->ontology, "console") == 0;
    struct mu_text answer = mu_text_in(r->group->answer, sizeof r->group->answer);
    mu_result (*carry_out)(struct mind *, const char *, struct mu_text *) =
        aside_begin(r, mail) ? mind_line : line_set_aside;
    bool done = is_console ? console_answer(r, mail, carry_out)
                           : carry_out(r->mind, mail->content, &answer) == MU_OK;
    aside_end(r);
    if (!done && !is_console) {
        mu_log(MU_LOG_WARNING, "line-refused", "from=%s line=%s answer=%s", mail->src,
               mail->content, r->group->answer);
    }
    if (mail->reply_with[0] && !is_console) {
        line_answer(r, mail, done);
    }
    (void)robot_mind_mend(r);
    percept_ask(a, r->mind);
    lifecycle_do_wish(r, a);
    lifecycle_travel(r);
}

/* Answers in any state, whatever the rules do in the step. */
enum mu_take mail_take_question(void *self, mu_agent *a, const struct mu_mail *mail)
{
    struct robot *r = self;
    struct mind_mail letter = letter_of(mail, mail->number);
    percept_settle(r);
    struct mu_text answer = mu_text_in(r->group->answer, sizeof r->group->answer);
    if (!mind_answer(r->mind, &letter, &answer) || answer.cut) {
        return MU_PASS;
    }
    if (mu_agent_reply(a, mail, "tell", answer.at) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", mail->src);
    }
    return MU_TAKEN;
}

/* Reads a content of one or two names. */
static bool names_read(const char *content, char first[MU_NAME_MAX + 1],
                       char second[MU_NAME_MAX + 1])
{
    char words[3][MU_NAME_MAX + 2] = {"", "", ""};
    int read = sscanf(content, " %32s %32s %32s", words[0], words[1], words[2]);
    return read >= 1 && read <= 2 && mu_name_valid(words[0]) &&
           (read == 1 || mu_name_valid(words[1])) &&
           mu_text_copy(first, MU_NAME_MAX + 1, words[0]) &&
           mu_text_copy(second, MU_NAME_MAX + 1, words[1]);
}

/* Begins a migration, which answers at its end. */
static void travel_begin(struct robot *r, const struct mind_travel *travel, bool good,
                         const struct mu_mail *mail)
{
    if (good) {
        (void)migration_begin(r, travel, mail);
    } else if (mail->reply_with[0] &&
               mu_agent_reply(r->agent, mail, "failure",
                              travel->kind == MIND_MOVES ? "expected HOST"
                                                         : "expected NAME [HOST]") != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", mail->src);
    }
}

static void directive_move(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct mind_travel travel = {.kind = MIND_MOVES};
    char none[MU_NAME_MAX + 1];
    bool good = names_read(mail->content, travel.host, none) && !none[0];
    travel_begin(r, &travel, good, mail);
}

static void directive_clone(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct mind_travel travel = {.kind = MIND_CLONES};
    bool good =
        names_read(mail->content, travel.name, travel.host) && !mu_name_reserved(travel.name);
    travel_begin(r, &travel, good, mail);
}

/* The same as requests: a robot grants them, unless its rules claim layer 1. */
enum mu_take mail_take_dispatch(void *self, mu_agent *a, const struct mu_mail *mail)
{
    directive_move(self, a, mail);
    return MU_TAKEN;
}

enum mu_take mail_take_clone(void *self, mu_agent *a, const struct mu_mail *mail)
{
    directive_clone(self, a, mail);
    return MU_TAKEN;
}

/* Fires N rules, in as many control steps as that takes. */
static void directive_step(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    char *end;
    long long rules = strtoll(mail->content, &end, 10);
    bool good = end != mail->content && *end == '\0' && rules >= 1 && rules <= UINT32_MAX;
    if (good) {
        mu_agent_set_state(a, MU_RUNNING);
        r->rules_left = (uint32_t)rules;
    } else {
        mu_log(MU_LOG_WARNING, "step-refused", "from=%s rules=%s", mail->src, mail->content);
    }
    mu_result sent = MU_OK;
    if (mail->reply_with[0]) {
        sent = mu_agent_reply(a, mail, good ? "agree" : "refuse", "step");
    }
    if (sent != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", mail->src);
    }
}

static void directive_console(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    console_directive(r, mail);
}

static void directive_words(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    console_words(r, mail);
}

void mail_on_directive(void *self, mu_agent *a, const struct mu_mail *mail)
{
    static const struct {
        const char *performative;
        void (*carry_out)(struct robot *r, mu_agent *a, const struct mu_mail *mail);
    } directives[] = {{"do", directive_do},           {"step", directive_step},
                      {"move", directive_move},       {"clone", directive_clone},
                      {"console", directive_console}, {"words", directive_words}};
    for (size_t i = 0; i < sizeof directives / sizeof directives[0]; i++) {
        if (strcmp(mail->performative, directives[i].performative) == 0) {
            percept_settle(self);
            directives[i].carry_out(self, a, mail);
            return;
        }
    }
    mu_log(MU_LOG_WARNING, "unknown-directive", "verb=%s from=%s", mail->performative, mail->src);
    mail_refuse_directive(a, mail);
}

void mail_refuse_directive(mu_agent *a, const struct mu_mail *mail)
{
    char content[2 * MU_FIELD_MAX];
    struct mu_text t = mu_text_in(content, sizeof content);
    mu_text_format(&t, "%s %s", mail->performative, mu_refusal_word(MU_REFUSAL_UNSUPPORTED));
    if (mail->reply_with[0] && mu_agent_reply(a, mail, "refuse", content) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", mail->src);
    }
}
