/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/clock.h"
#include "core/exits.h"
#include "core/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t AWAY_NS = 900000000;
static const uint64_t READ_NS = 50000000;
static const uint64_t WORDS_PATIENCE_NS = 5000000000; /* then they are asked for again */

/* line: that it is said to; 0: none in particular */
static void show(struct console_link *l, enum console_kind kind, uint64_t line, const char *text)
{
    if (l->show) {
        l->show(l->self, kind, line, text);
    }
}

static void tell_end(struct console_link *l, const struct console_pending *p, bool good)
{
    if (l->ended) {
        l->ended(l->self, p->number, good);
    }
}

static void show_note(struct console_link *l, uint64_t line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void show_note(struct console_link *l, uint64_t line, const char *format, ...)
{
    char note[256];
    va_list args;
    va_start(args, format);
    vsnprintf(note, sizeof note, format, args);
    va_end(args);
    show(l, CONSOLE_NOTE, line, note);
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
    return mu_agent_send(l->asker, &mail, seq);
}

/* --- lines and their answers ------------------------------------------------------------------ */

static mu_result line_send(struct console_link *l, struct console_pending *p, const char *line)
{
    char label[24];
    snprintf(label, sizeof label, "line-%llu", (unsigned long long)p->number);
    return directive_send(l, "do", line, label, &p->seq);
}

/* What was typed before it is to be done before it. */
static bool may_look(const struct console_link *l)
{
    bool may = true;
    for (size_t i = 0; i < l->pending_count; i++) {
        may = may && l->pending[i].glance > 0;
    }
    return may;
}

static bool look_send(struct console_link *l, struct console_pending *p, const char *line)
{
    bool sent = may_look(l) && probes_ask(l->asker, l->agent, line, &p->glance) == MU_OK;
    return sent && mu_text_copy(p->look, sizeof p->look, line);
}

mu_result console_link_line(struct console_link *l, const char *line, uint64_t *number)
{
    struct console_pending *p = &l->pending[l->pending_count];
    if (l->pending_count >= l->pending_max) {
        return MU_FULL;
    }
    *p = (struct console_pending){.number = l->lines + 1};
    bool looks = look_send(l, p, line);
    if (!looks) {
        MU_TRY(line_send(l, p, line));
    }
    l->lines++;
    l->heard_ns = mu_clock_ns();
    l->pending_count++;
    l->words_stale = l->words_stale || !looks;
    if (number) {
        *number = p->number;
    }
    return MU_OK;
}

/* The oldest count of them have no more to come. */
static void pending_drop(struct console_link *l, size_t count, bool good)
{
    for (size_t i = 0; i < count; i++) {
        tell_end(l, &l->pending[i], good);
    }
    l->pending_count -= count;
    memmove(l->pending, l->pending + count, l->pending_count * sizeof l->pending[0]);
}

void console_link_forget(struct console_link *l)
{
    pending_drop(l, l->pending_count, false);
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
        show_note(l, 0, "[the answers to %zu lines, or their ends, are lost]", passed);
        pending_drop(l, passed, false);
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
        show_note(l, number, "[%u pieces of this answer are lost]", piece - p->piece - 1);
    }
    p->piece = piece;
    l->heard_ns = mu_clock_ns();
    if (strcmp(mail->performative, "not-understood") == 0) {
        show_note(l, number, "muster: %s has no mind of CLIPS: not understood", l->agent);
    } else {
        show(l, fails ? CONSOLE_FAILURE : CONSOLE_ANSWER, number, mail->content);
    }
    if (piece >= count) {
        l->failures += fails;
        pending_drop(l, 1, !fails);
    }
}

static struct console_pending *glance_find(struct console_link *l, uint64_t number)
{
    for (size_t i = 0; i < l->pending_count; i++) {
        if (l->pending[i].glance == number) {
            return &l->pending[i];
        }
    }
    return NULL;
}

/* The line goes as any other does, behind what was typed since. */
static void glance_declined(struct console_link *l, const struct console_pending *p)
{
    struct console_pending again = {.number = p->number};
    mu_result sent = line_send(l, &again, p->look);
    size_t behind = (size_t)(&l->pending[l->pending_count] - p) - 1;
    memmove(&l->pending[p - l->pending], p + 1, behind * sizeof *p);
    if (sent == MU_OK) {
        l->pending[l->pending_count - 1] = again;
        return;
    }
    l->pending_count--;
    show_note(l, again.number, "[a line is lost: %s]", mu_result_text(sent));
    tell_end(l, &again, false);
}

void console_link_glance(struct console_link *l, uint64_t number, enum probe_end end,
                         const char *text)
{
    struct console_pending *p = l->agent ? glance_find(l, number) : NULL;
    if (!p) {
        return; /* given up, or another link's */
    }
    l->heard_ns = mu_clock_ns();
    if (end == PROBE_DECLINED) {
        glance_declined(l, p);
        return;
    }
    bool fails = end == PROBE_FAILED;
    p = pending_meet(l, p->number);
    show(l, fails ? CONSOLE_FAILURE : CONSOLE_ANSWER, p->number, text);
    l->failures += fails;
    pending_drop(l, 1, !fails);
}

/* --- what is watched, and words --------------------------------------------------------------- */

void console_link_attach(struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->process, l->agent);
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
        show_note(l, 0, "[%llu lines came faster than this console reads, and are lost]", lost);
    }
    show(l, CONSOLE_TRACE, 0, mail->content);
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

mu_result console_link_detach(struct console_link *l, uint64_t *seq)
{
    bool was = l->attached;
    l->attached = false;
    return was ? directive_send(l, "console", "detach", "", seq) : MU_DONE;
}

void console_link_ask_words(struct console_link *l)
{
    char label[24];
    uint64_t number = l->lines + 1;
    uint64_t now_ns = mu_clock_ns();
    bool waits = l->words_asked > 0 && now_ns - l->words_asked_ns < WORDS_PATIENCE_NS;
    snprintf(label, sizeof label, "words-%llu", (unsigned long long)number);
    if (!waits && directive_send(l, "words", "", label, NULL) == MU_OK) {
        l->lines = l->words_asked = number;
        l->words_asked_ns = now_ns;
        l->words_stale = false;
    }
}

/* They count when all of them are there. */
static void words_take(struct console_link *l, const struct mu_mail *mail, uint64_t number)
{
    unsigned count, piece = piece_of(mail, &count);
    if (number != l->words_asked) {
        return; /* given up */
    }
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

void console_link_mail(struct console_link *l, const struct mu_mail *mail)
{
    unsigned long long number;
    bool ours = l->agent && strcmp(mail->src, l->agent) == 0; /* or no agent is looked at yet */
    if (ours && strcmp(mail->performative, "trace") == 0) {
        if (l->attached) { /* else it was for an earlier console of our name */
            trace_take(l, mail);
        }
    } else if (ours && sscanf(mail->in_reply_to, "line-%llu", &number) == 1) {
        answer_take(l, mail, number);
    } else if (ours && sscanf(mail->in_reply_to, "words-%llu", &number) == 1) {
        words_take(l, mail, number);
    }
}

static bool is_good(enum mu_outcome outcome)
{
    return outcome == MU_MAIL_DELIVERED || outcome == MU_MAIL_STORED ||
           outcome == MU_MAIL_DUPLICATE;
}

/* A line that was not delivered has no answer. */
void console_link_receipt(struct console_link *l, uint64_t first_seq, uint64_t last_seq,
                          enum mu_outcome outcome)
{
    size_t kept = 0;
    for (size_t i = 0; i < l->pending_count && !is_good(outcome); i++) {
        struct console_pending p = l->pending[i];
        if (p.glance > 0 || p.seq < first_seq || p.seq > last_seq) {
            l->pending[kept++] = p;
            continue;
        }
        l->code = answer_outcome_exit(outcome);
        show_note(l, p.number, "muster: to %s: %s%s", l->agent, mu_outcome_text(outcome),
                  answer_outcome_advice(outcome, l->agent));
        tell_end(l, &p, false);
    }
    l->pending_count = is_good(outcome) ? l->pending_count : kept;
}

/* A robot that was started again knows nothing of us; and when we were away ourselves, pieces may
 * be lost that we would have said we had read. */
static void attach_again(struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->process, l->agent);
    uint64_t now_ns = mu_clock_ns();
    bool was_away = l->spun_ns > 0 && now_ns - l->spun_ns > AWAY_NS;
    bool is_there = mu_process_has_broker(l->process);
    bool is_other = m && m->state != MU_GONE && m->pid != l->agent_pid;
    l->spun_ns = is_there ? now_ns : l->spun_ns;
    if (l->attached && is_there && (was_away || is_other)) {
        console_link_attach(l);
    }
}

/* Why a line has no answer yet: said once. */
static void busy_look(struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->process, l->agent);
    if (l->pending_count > 0 && l->busy_number != l->lines && m && m->busy_since_wall_ns > 0) {
        l->busy_number = l->lines;
        show_note(l, 0, "[%s is %s]", l->agent, m->reason);
    }
}

void console_link_round(struct console_link *l)
{
    attach_again(l);
    busy_look(l);
    trace_renew(l);
}

enum mu_state console_link_state(const struct console_link *l)
{
    const struct mu_member *m = mu_process_lookup(l->process, l->agent);
    return m ? m->state : MU_GONE;
}

void console_link_init(struct console_link *l, mu_process *process, mu_agent *asker,
                       const char *agent)
{
    l->process = process;
    l->asker = asker;
    l->agent = agent;
    /* The observer asks others, each line as long as it takes: its answers overtake each other. */
    l->pending_max = strcmp(agent, "observer") == 0 ? 1 : CONSOLE_PENDING_MAX;
}
