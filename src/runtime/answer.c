/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/answer.h"

#include "runtime/process.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { ANSWER_NUMBERS = 8, ANSWER_MAIL_NUMBERS = 6, LEN_DIGITS = 10 };

/* --- writing ---------------------------------------------------------------------------------- */

/* With its length before it, so that it may have any byte in it. */
static void string_add(struct mu_text *out, const char *s)
{
    mu_text_format(out, "%zu:%s", strlen(s), s);
}

static void mail_add(struct mu_text *out, const muster_Mail *m)
{
    mu_text_format(out, "%" PRIu32 " %" PRId32 " %d %" PRIu64 " %" PRId64 " %" PRIu64 " ", m->layer,
                   m->priority, (int)m->level, m->reply_by_ns, m->due_ns, m->ttl_ns);
    const char *const strings[] = {m->dst,        m->performative, m->language,     m->ontology,
                                   m->reply_with, m->in_reply_to,  m->conversation, m->content};
    for (size_t i = 0; i < sizeof strings / sizeof strings[0]; i++) {
        string_add(out, strings[i]);
    }
}

static uint32_t earlier_count(const struct outbox *box)
{
    uint32_t count = 0;
    for (uint64_t seq = box->first_seq; seq < box->unsent_seq; seq++) {
        count += outbox_awaited(box, seq) != NULL;
    }
    return count;
}

/* Mail of earlier steps that the broker has not answered for: how far before the first of this
 * step, whether it is a directive, and its receivers. */
static void earlier_add(struct mu_text *out, const struct outbox *box)
{
    uint32_t count = earlier_count(box);
    if (count > 0) {
        mu_text_format(out, "earlier %" PRIu32 " ", count);
    }
    for (uint64_t seq = box->first_seq; seq < box->unsent_seq; seq++) {
        const muster_Mail *m = outbox_awaited(box, seq);
        if (m) {
            mu_text_format(out, "%" PRIu64 " %d ", box->unsent_seq - seq,
                           m->layer == WIRE_DIRECTIVE);
            string_add(out, m->dst);
        }
    }
}

static size_t body_add(struct mu_text *out, const muster_Act *act, const struct outbox *box)
{
    size_t start = out->len;
    earlier_add(out, box);
    string_add(out, act->rules);
    for (uint32_t i = 0; i < act->mails._length; i++) {
        mail_add(out, &act->mails._buffer[i]);
    }
    return out->len - start;
}

static const char none[] = "answer none\n";

/* @return where the length of what follows stands, for who knows it only behind that */
static size_t head_add(struct mu_text *out, const struct answer *a)
{
    mu_text_format(out, "answer %d %.17g %.17g %d %d %u %u", a->drives, a->forward_m_s,
                   a->turn_rad_s, a->paddles, a->lift, a->firings, a->mails);
    mu_text_format(out, " %*zu\n", LEN_DIGITS, a->len);
    return out->len - LEN_DIGITS - 1;
}

void answer_add(struct mu_text *out, const mu_agent *a)
{
    const mu_process *p = a->process;
    if (p->up_state != UP_ANSWERING) {
        mu_text_add(out, none);
        return;
    }
    const muster_Act *act = &p->acts[a->act];
    size_t place = head_add(out, &(struct answer){.drives = act->drives,
                                                  .forward_m_s = act->forward_m_s,
                                                  .turn_rad_s = act->turn_rad_s,
                                                  .paddles = act->paddles,
                                                  .lift = act->lift,
                                                  .firings = act->firings,
                                                  .mails = act->mails._length});
    size_t len = body_add(out, act, &a->outbox);
    char digits[LEN_DIGITS + 1];
    snprintf(digits, sizeof digits, "%*zu", LEN_DIGITS, len);
    if (!out->cut) {
        memcpy(out->at + place, digits, LEN_DIGITS);
    }
    mu_text_add(out, "\n");
}

void answer_keep(struct mu_text *out, const struct answer *kept)
{
    if (!kept->text) {
        mu_text_add(out, none);
        return;
    }
    (void)head_add(out, kept);
    mu_text_format(out, "%.*s\n", (int)kept->len, kept->text);
}

/* --- reading ---------------------------------------------------------------------------------- */

bool answer_read(const char **text, struct answer *out)
{
    int drives = 0, head = 0;
    *out = (struct answer){.text = NULL};
    if (strncmp(*text, none, sizeof none - 1) == 0) {
        *text += sizeof none - 1;
        return true;
    }
    int read = sscanf(*text, "answer %d %lf %lf %d %d %u %u %zu%n", &drives, &out->forward_m_s,
                      &out->turn_rad_s, &out->paddles, &out->lift, &out->firings, &out->mails,
                      &out->len, &head);
    if (read != ANSWER_NUMBERS || (*text)[head] != '\n') {
        return false;
    }
    out->drives = drives != 0;
    out->text = *text + head + 1;
    if (strnlen(out->text, out->len + 1) <= out->len || out->text[out->len] != '\n') {
        return false;
    }
    *text = out->text + out->len + 1;
    return true;
}

/* What is still to be read of a text. */
struct rest {
    const char *at, *end;
};

/* Copies a string, of at most size - 1 bytes.  @return whether there was one */
static bool string_take(struct rest *r, char *to, size_t size)
{
    size_t len = 0;
    int head = 0;
    if (r->at >= r->end || sscanf(r->at, "%zu:%n", &len, &head) != 1 || head == 0 || len >= size ||
        len > (size_t)(r->end - r->at - head)) {
        return false;
    }
    memcpy(to, r->at + head, len);
    to[len] = '\0';
    r->at += head + len;
    return true;
}

/* The strings of the mail at hand. */
struct strings {
    char dst[MU_DST_MAX + 1], content[MU_CONTENT_MAX + 1];
    char others[6][MU_FIELD_MAX + 1];
};

static bool strings_take(struct rest *r, struct strings *s)
{
    bool good = string_take(r, s->dst, sizeof s->dst);
    for (size_t i = 0; i < sizeof s->others / sizeof s->others[0]; i++) {
        good = good && string_take(r, s->others[i], sizeof s->others[i]);
    }
    return good && string_take(r, s->content, sizeof s->content);
}

static bool mail_repeat(mu_agent *a, struct rest *r)
{
    static struct strings s;
    uint32_t layer;
    int priority, level, head = 0;
    uint64_t reply_by_ns, ttl_ns;
    int64_t due_ns;
    if (r->at >= r->end ||
        sscanf(r->at, "%" SCNu32 " %d %d %" SCNu64 " %" SCNd64 " %" SCNu64 " %n", &layer, &priority,
               &level, &reply_by_ns, &due_ns, &ttl_ns, &head) != ANSWER_MAIL_NUMBERS) {
        return false;
    }
    r->at += head;
    struct mu_mail mail = {.dst = s.dst,
                           .directive = layer == WIRE_DIRECTIVE,
                           .layer = layer,
                           .performative = s.others[0],
                           .language = s.others[1],
                           .ontology = s.others[2],
                           .reply_with = s.others[3],
                           .in_reply_to = s.others[4],
                           .conversation = s.others[5],
                           .content = s.content,
                           .reply_by_ns = reply_by_ns,
                           .priority = (enum mu_priority)priority,
                           .level = (enum mu_level)level,
                           .timed = due_ns >= 0,
                           .due_ns = due_ns >= 0 ? (uint64_t)due_ns : 0,
                           .ttl_ns = ttl_ns};
    return strings_take(r, &s) && mu_agent_send(a, &mail, NULL) == MU_OK;
}

/* Puts back what earlier steps said and the broker has not answered for.
 * @param said  so many mails of the answer the broker has had, too */
static bool earlier_take(mu_agent *a, struct rest *r, unsigned said)
{
    static char dst[MU_DST_MAX + 1];
    struct outbox *box = &a->outbox;
    uint64_t back = 0, first = box->next_seq - said;
    unsigned count = 0;
    int head = 0, directive;
    if (r->at < r->end && sscanf(r->at, "earlier %u %n", &count, &head) == 1) {
        r->at += head;
    }
    for (unsigned i = 0; i < count; i++) {
        if (r->at >= r->end || sscanf(r->at, "%" SCNu64 " %d %n", &back, &directive, &head) != 2 ||
            back > first) {
            return false;
        }
        r->at += head;
        if (!string_take(r, dst, sizeof dst)) {
            return false;
        }
        if (i == 0) {
            outbox_rewind(box, back + said);
        }
        const struct mu_mail mail = {.dst = dst, .directive = directive != 0};
        outbox_recall(box, a->name, first - back, &mail);
    }
    if (count > 0) {
        outbox_recall(box, a->name, first, NULL);
    } else {
        outbox_rewind(box, said);
    }
    return true;
}

static bool mails_repeat(mu_agent *a, struct rest *r, const struct answer *kept)
{
    bool good = true;
    for (unsigned i = 0; i < kept->mails && good; i++) {
        good = mail_repeat(a, r);
    }
    return good && r->at == r->end;
}

static char rules[PROCESS_RULES_MAX + 1];

bool answer_repeat(mu_agent *a, const struct answer *kept, bool broker_had)
{
    struct rest r = {kept->text, kept->text + kept->len};
    bool good =
        earlier_take(a, &r, broker_had ? kept->mails : 0) && string_take(&r, rules, sizeof rules) &&
        (!kept->drives || mu_agent_drive(a, kept->forward_m_s, kept->turn_rad_s) == MU_OK) &&
        mu_agent_grip(a, (enum mu_paddles)kept->paddles, (enum mu_lift)kept->lift) == MU_OK;
    if (good) {
        mu_agent_fired(a, kept->firings, rules);
    }
    return good && mails_repeat(a, &r, kept);
}

bool answer_recall(mu_agent *a, const struct answer *kept)
{
    struct rest r = {kept->text, kept->text + kept->len};
    bool good = earlier_take(a, &r, kept->mails) && string_take(&r, rules, sizeof rules) &&
                mails_repeat(a, &r, kept);
    outbox_sent(&a->outbox, (uint32_t)(a->outbox.next_seq - a->outbox.unsent_seq));
    return good;
}
