/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/exits.h"
#include "core/json.h"
#include "muster/refusal.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* What an answer's performative may say of the question. */
static const struct {
    const char *performative;
    const char *said; /* to a person, on standard error; NULL: the content says it all */
} failures[] = {
    {"refuse", "refuses"},
    {"not-understood", "has not understood"},
    {"failure", NULL},
};

/* @return its row, or -1 */
static int failure_find(const struct mu_mail *mail)
{
    for (int i = 0; i < (int)(sizeof failures / sizeof failures[0]); i++) {
        if (strcmp(mail->performative, failures[i].performative) == 0) {
            return i;
        }
    }
    return -1;
}

bool answer_is_failure(const struct mu_mail *mail)
{
    return failure_find(mail) >= 0;
}

static void byte_print(FILE *to, char byte, bool terminal)
{
    bool steers = ((unsigned char)byte < ' ' && byte != '\n' && byte != '\t') || byte == 0x7f;
    putc(terminal && steers ? '?' : byte, to);
}

void answer_text_print(FILE *to, const char *text)
{
    bool terminal = isatty(fileno(to));
    for (; *text; text++) {
        byte_print(to, *text, terminal);
    }
}

void answer_content_print(FILE *to, const char *content)
{
    bool terminal = isatty(fileno(to));
    size_t len = strlen(content);
    bool quoted = len >= 2 && content[0] == '"' && content[len - 1] == '"';
    for (size_t i = quoted; i < len - quoted; i++) {
        if (quoted && content[i] == '\\' && i + 1 < len - quoted) {
            i++;
        }
        byte_print(to, content[i], terminal);
    }
    size_t last = len - quoted;
    if (last <= (size_t)quoted || content[last - 1] != '\n') {
        putc('\n', to);
    }
}

static const char *level_text(enum mu_level level)
{
    static const char *const texts[] = {"ram", "logged", "synced"};
    return (unsigned)level < sizeof texts / sizeof texts[0] ? texts[level] : "unknown";
}

static const char *priority_text(enum mu_priority priority)
{
    if (priority == MU_PRIORITY_NORMAL) {
        return "normal";
    }
    return priority < MU_PRIORITY_NORMAL ? "low" : "high";
}

/* @return why that is refused, if it is and its code is known */
static enum mu_refusal code_of(const struct mu_mail *mail)
{
    enum mu_refusal code = mu_refusal_named(mail->content); /* a host says no more than that */
    code = code != MU_REFUSAL_NONE ? code : mu_refusal_of(mail->content);
    return answer_is_failure(mail) ? code : MU_REFUSAL_NONE;
}

int answer_exit(const struct mu_mail *mail)
{
    static const enum mu_refusal refused[] = {MU_REFUSAL_NAME_HELD, MU_REFUSAL_NAME_TAKEN,
                                              MU_REFUSAL_STATE, MU_REFUSAL_UNSUPPORTED,
                                              MU_REFUSAL_POLICY};
    int code = answer_is_failure(mail) ? MU_EXIT_UNDELIVERED : MU_EXIT_DONE;
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        code = code_of(mail) == refused[i] ? MU_EXIT_REFUSED : code;
    }
    return code;
}

static void object_print(const struct mu_mail *mail)
{
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "from", mail->src);
    mu_json_string(&j, "to", mail->dst);
    mu_json_uint(&j, "seq", mail->seq);
    mu_json_uint(&j, "layer", mail->layer);
    mu_json_string(&j, "performative", mail->performative);
    mu_json_string(&j, "language", mail->language);
    mu_json_string(&j, "ontology", mail->ontology);
    mu_json_string(&j, "reply_with", mail->reply_with);
    mu_json_string(&j, "in_reply_to", mail->in_reply_to);
    mu_json_string(&j, "conversation", mail->conversation);
    mu_json_real(&j, "reply_by_s", (double)mail->reply_by_ns / 1e9);
    mu_json_string(&j, "priority", priority_text(mail->priority));
    mu_json_string(&j, "level", level_text(mail->level));
    mu_json_real(&j, "ttl_s", (double)mail->ttl_ns / 1e9);
    mu_json_string(&j, "content", mail->content);
    if (code_of(mail) != MU_REFUSAL_NONE) {
        mu_json_string(&j, "code", mu_refusal_word(code_of(mail)));
    }
    mu_json_end(&j);
}

void answer_print(const struct mu_mail *mail, bool json)
{
    int failure = failure_find(mail);
    const char *said = failure >= 0 ? failures[failure].said : NULL;
    if (json) {
        object_print(mail);
    }
    if (said && code_of(mail) != MU_REFUSAL_NONE) {
        fprintf(stderr, "muster: %s %s: ", mail->src, said);
        answer_text_print(stderr, mail->content);
        fprintf(stderr, "; %s\n", mu_refusal_text(code_of(mail)));
    } else if (said) {
        fprintf(stderr, "muster: %s %s: ", mail->src, said);
        answer_content_print(stderr, mail->content);
    } else if (!json) {
        printf("%s: ", mail->src);
        answer_content_print(stdout, mail->content);
    }
}

int answer_outcome_exit(enum mu_outcome outcome)
{
    switch (outcome) {
    case MU_MAIL_DELIVERED:
    case MU_MAIL_STORED:
    case MU_MAIL_DUPLICATE: return MU_EXIT_DONE;
    case MU_MAIL_UNKNOWN_NAME: return MU_EXIT_NO_AGENT;
    case MU_MAIL_REFUSED: return MU_EXIT_REFUSED;
    case MU_MAIL_NO_STORE: return MU_EXIT_WRITE;
    case MU_MAIL_EXPIRED:
    case MU_MAIL_DROPPED:
    case MU_MAIL_BOX_FULL: return MU_EXIT_UNDELIVERED;
    }
    return MU_EXIT_UNDELIVERED;
}

const char *answer_outcome_advice(enum mu_outcome outcome, const char *to)
{
    if (outcome == MU_MAIL_REFUSED) {
        return " by the trust policy of its broker";
    }
    if (outcome == MU_MAIL_NO_STORE) {
        return "; its broker cannot write to its disk, and its log says why";
    }
    if (outcome != MU_MAIL_UNKNOWN_NAME) {
        return "";
    }
    if (strncmp(to, "group:", strlen("group:")) == 0) {
        return "; muster group list lists groups";
    }
    return strchr(to, ':') ? "; no agent fits that, or no resolver is there that knows it"
                           : "; muster ps lists all agents";
}

const char *answer_travel_advice(const char *content)
{
    const char *text = mu_refusal_text(mu_refusal_of(content));
    return text[0] ? text : NULL;
}
