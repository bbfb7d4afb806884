/* SPDX-License-Identifier: Apache-2.0 */
#include "ctl/console_link.h"

#include "core/clock.h"
#include "core/exits.h"
#include "core/text.h"
#include "ctl/answer.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t GOODBYE_NS = 300000000;
static const uint64_t AWAY_NS = 900000000;
static const uint64_t READ_NS = 50000000;
static const int64_t ROUND_NS = 20000000;

static void show(struct console_link *l, enum console_kind kind, const char *text)
{
    if (l->show) {
        l->show(l->self, kind, text);
    }
}

static void show_note(struct console_link *l, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void show_note(struct console_link *l, const char *format, ...)
{
    char note[256];
    va_list args;
    va_start(args, format);
    vsnprintf(note, sizeof note, format, args);
    va_end(args);
    show(l, CONSOLE_NOTE, note);
}

static mu_result directive_send(struct console_link *l, const char *performative,
                                const char *content, const char *label, uint64_t *seq)
{
    struct mu_mail mail = {.dst = l->agent,
                           .directive = true,
                           .performative = performative,
                           .ontology = "console",
                           .reply_with = label,
                           .content = content};
    return mu_agent_send(l->op.agent, &mail, seq);
}

/* --- lines and their answers ------------------------------------------------------------------ */

mu_result console_link_line(struct console_link *l, const char *line)
{
    char label[24];
    struct console_pending *p = &l->pending[l->pending_count];
    if (l->pending_count >= l->pending_max) {
        return MU_FULL;
    }
    *p = (struct console_pending){.number = l->lines + 1};
    snprintf(label, sizeof label, "line-%llu", (unsigned long long)p->number);
    MU_TRY(directive_send(l, "do", line, label, &p->seq));
    l->lines++;
    l->heard_ns = mu_clock_ns();
    l->pending_count++;
    l->words_stale = true;
    return MU_OK;
}

static void pending_drop(struct console_link *l, size_t count)
{
    l->pending_count -= count;
    memmove(l->pending, l->pending + count, l->pending_count * sizeof l->pending[0]);
}

void console_link_forget(struct console_link *l)
{
    pending_drop(l, l->pending_count);
}

/* Answers come in the order of the lines: what a later one has overtaken will not come. */
static struct console_pending *pending_meet(struct console_link *l, uint64_t number)
{
    size_t passed = 0;
    while (passed < l->pending_count && l->pending[passed].number < number) {
        passed++;
    }
    if (passed == l->pending_count || l->pending[passed].number != number) {
        return NULL;
    }
    if (passed > 0) {
        show_note(l, "[the answers to %zu lines, or their ends, are lost]", passed);
        pending_drop(l, passed);
        l->code = MU_EXIT_TIME;
    }
    return &l->pending[0];
}

/* "piece 2 3"; an answer that is not in pieces is the only one.  @return which, of how many */
static unsigned piece_of(const struct mu_mail *mail, unsigned *count)
{
    unsigned piece = 1;
    *count = 1;
    if (sscanf(mail->ontology, "piece %u %u", &piece, count) != 2 || piece < 1) {
        piece = *count = 1;
    }
    return piece;
}

static void answer_take(struct console_link *l, const struct mu_mail *mail, uint64_t number)
{
    struct console_pending *p = pending_meet(l, number);
    unsigned count, piece = piece_of(mail, &count);
    bool fails = answer_is_failure(mail);
    if (!p) {
        return; /* given up */
    }
    if (piece > p->piece + 1) {
        show_note(l, "[%u pieces of this answer are lost]", piece - p->piece - 1);
    }
    p->piece = piece;
    l->heard_ns = mu_clock_ns();
    show(l, fails ? CONSOLE_FAILURE : CONSOLE_ANSWER, mail->content);
    if (piece >= count) {
        l->failures += fails;
        pending_drop(l, 1);
    }
}

/* --- what is watched, and words --------------------------------------------------------------- */

void console_link_attach(struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->op.process, l->agent);
    char content[32];
    snprintf(content, sizeof content, "attach %d", CONSOLE_CREDIT);
    l->attached = directive_send(l, "console", content, "attach", NULL) == MU_OK;
    l->agent_pid = m ? m->pid : 0;
    l->used = 0;
}

static void trace_take(struct console_link *l, const struct mu_mail *mail)
{
    unsigned long long lost = 0;
    if (sscanf(mail->ontology, "lost %llu", &lost) == 1 && lost > 0) {
        show_note(l, "[%llu lines came faster than this console reads, and are lost]", lost);
    }
    show(l, CONSOLE_TRACE, mail->content);
    l->used_ns = l->used++ == 0 ? mu_clock_ns() : l->used_ns;
}

/* It has read: not after each piece, which would be a mail for a mail. */
static void trace_renew(struct console_link *l)
{
    char content[32];
    bool due = l->used >= CONSOLE_CREDIT / 2 || mu_clock_ns() - l->used_ns > READ_NS;
    if (l->used == 0 || !due) {
        return;
    }
    snprintf(content, sizeof content, "more %u", l->used);
    if (directive_send(l, "console", content, "", NULL) == MU_OK) {
        l->used = 0;
    }
}

void console_link_ask_words(struct console_link *l)
{
    char label[24];
    uint64_t number = l->lines + 1;
    snprintf(label, sizeof label, "words-%llu", (unsigned long long)number);
    if (l->words_asked == 0 && directive_send(l, "words", "", label, NULL) == MU_OK) {
        l->lines = l->words_asked = number;
        l->words_stale = false;
    }
}

/* They count when all of them are there. */
static void words_take(struct console_link *l, const struct mu_mail *mail)
{
    unsigned count, piece = piece_of(mail, &count);
    struct mu_text words = {.at = l->words, .len = l->words_len, .size = sizeof l->words};
    if (piece == 1) {
        mu_text_clear(&words);
    }
    if (!answer_is_failure(mail)) {
        mu_text_add(&words, mail->content);
    }
    l->words_len = words.len;
    l->words_asked = piece >= count ? 0 : l->words_asked;
}

/* --- what comes ------------------------------------------------------------------------------- */

static void on_mail(void *self, const struct mu_mail *mail)
{
    struct console_link *l = self;
    unsigned long long number;
    bool ours = strcmp(mail->src, l->agent) == 0;
    if (ours && strcmp(mail->performative, "trace") == 0) {
        if (l->attached) { /* else it was for an earlier console of our name */
            trace_take(l, mail);
        }
    } else if (ours && sscanf(mail->in_reply_to, "line-%llu", &number) == 1) {
        answer_take(l, mail, number);
    } else if (ours && sscanf(mail->in_reply_to, "words-%llu", &number) == 1) {
        words_take(l, mail);
    }
}

static bool is_good(enum mu_outcome outcome)
{
    return outcome == MU_MAIL_DELIVERED || outcome == MU_MAIL_STORED ||
           outcome == MU_MAIL_DUPLICATE;
}

/* A line that was not delivered has no answer. */
static void on_receipt(void *self, uint64_t first_seq, uint64_t last_seq, enum mu_outcome outcome)
{
    struct console_link *l = self;
    size_t kept = 0;
    bool none = false;
    for (size_t i = 0; i < l->pending_count && !is_good(outcome); i++) {
        if (l->pending[i].seq >= first_seq && l->pending[i].seq <= last_seq) {
            none = true;
        } else {
            l->pending[kept++] = l->pending[i];
        }
    }
    if (none) {
        l->pending_count = kept;
        l->code = operator_outcome_exit(outcome);
        show_note(l, "muster: to %s: %s", l->agent, mu_outcome_text(outcome));
    }
}

/* A robot that was started again knows nothing of us; and when we were away ourselves, pieces may
 * be lost that we would have said we had read. */
static void attach_again(struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->op.process, l->agent);
    uint64_t now_ns = mu_clock_ns();
    bool was_away = l->spun_ns > 0 && now_ns - l->spun_ns > AWAY_NS;
    bool is_there = mu_process_has_broker(l->op.process);
    bool is_other = m && m->state != MU_GONE && m->pid != l->agent_pid;
    l->spun_ns = is_there ? now_ns : l->spun_ns;
    if (l->attached && is_there && (was_away || is_other)) {
        console_link_attach(l);
    }
}

/* Why a line has no answer yet: said once. */
static void busy_look(struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->op.process, l->agent);
    if (l->pending_count > 0 && l->busy_number != l->lines && m && operator_is_busy(m)) {
        l->busy_number = l->lines;
        show_note(l, "[%s is %s]", l->agent, m->reason);
    }
}

mu_result console_link_spin(struct console_link *l, int64_t timeout_ns)
{
    mu_result spun = mu_process_spin(l->op.process, timeout_ns);
    attach_again(l);
    busy_look(l);
    trace_renew(l);
    return spun;
}

enum mu_state console_link_state(const struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->op.process, l->agent);
    return m ? m->state : MU_GONE;
}

int console_link_open(struct console_link *l, struct operator_options *options, const char *agent)
{
    l->agent = agent;
    /* The observer asks others, each line as long as it takes: its answers overtake each other. */
    l->pending_max = strcmp(agent, "observer") == 0 ? 1 : CONSOLE_PENDING_MAX;
    l->hooks = (struct operator_hooks){l, on_mail, on_receipt};
    options->hooks = &l->hooks;
    options->only_reads = true;
    int code = operator_join(&l->op, options, "console");
    if (code != MU_EXIT_DONE) {
        return code;
    }
    const struct mu_member *m = mu_process_lookup(l->op.process, agent);
    if (!m || m->state == MU_GONE) {
        fprintf(stderr, "muster console: %s: %s; muster ps lists who is there\n", agent,
                m ? "absent" : "no such agent");
        return MU_EXIT_NO_AGENT;
    }
    return MU_EXIT_DONE;
}

void console_link_close(struct console_link *l)
{
    if (l->attached && directive_send(l, "console", "detach", "", &l->op.seq) == MU_OK) {
        uint64_t until_ns = mu_clock_ns() + GOODBYE_NS;
        l->op.answered_for = false;
        while (!l->op.answered_for && mu_clock_ns() < until_ns &&
               mu_process_spin(l->op.process, ROUND_NS) == MU_OK) {
        }
    }
    operator_leave(&l->op);
}
