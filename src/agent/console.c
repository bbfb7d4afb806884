/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Consoles that watch a robot.  They get long answers in pieces, and the lines that its rules
 * print.
 *
 * A console says how many pieces it has room for.  The rest is counted; the next piece says how
 * many lines were lost.  Nothing here waits.  docs/console.md has the protocol.
 */
#include "agent/robot.h"
#include "core/log.h"
#include "core/pieces.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct console *console_find(struct robot *r, const char *name)
{
    for (uint32_t i = 0; i < r->console_count; i++) {
        if (strcmp(r->consoles[i].name, name) == 0) {
            return &r->consoles[i];
        }
    }
    return NULL;
}

static void console_leave(struct robot *r, const char *name)
{
    struct console *c = console_find(r, name);
    if (c) {
        size_t behind = (size_t)(&r->consoles[--r->console_count] - c);
        memmove(c, c + 1, behind * sizeof *c);
    }
}

/* --- lines of the robot -------------------------------------------------------------------------
 * */

static uint32_t lines_count(const char *text)
{
    uint32_t lines = 0;
    for (; *text; text++) {
        lines += *text == '\n' || text[1] == '\0';
    }
    return lines;
}

/* Sends a console one piece.  @return whether it has room for it */
static bool trace_send(struct robot *r, struct console *c, const char *piece)
{
    char lost[MU_FIELD_MAX + 1];
    snprintf(lost, sizeof lost, "lost %llu", (unsigned long long)c->lost);
    struct mu_mail mail = {.dst = c->name,
                           .performative = "trace",
                           .language = "text",
                           .ontology = lost,
                           .content = piece};
    if (c->credit == 0 || mu_agent_send(r->agent, &mail, NULL) != MU_OK) {
        return false;
    }
    c->credit--;
    c->unread++;
    c->lost = 0;
    return true;
}

/* Sends all lines that the robot's consoles have not got yet. */
static void trace_flush(struct robot *r)
{
    struct group_process *group = r->group;
    char *piece = group->answer; /* no answer is being made */
    for (uint32_t i = 0; i < r->console_count; i++) {
        struct console *c = &r->consoles[i];
        const char *at = group->trace.at;
        while (mu_pieces_next(&at, piece, ROBOT_ANSWER_MAX)) {
            c->lost += trace_send(r, c, piece) ? 0 : lines_count(piece);
        }
        c->lost += group->trace_cut;
    }
    mu_text_clear(&group->trace);
    group->trace_cut = 0;
    group->traced = NULL;
}

void console_flush(struct robot *r)
{
    if (r->group->traced == r) {
        trace_flush(r);
    }
}

void console_end(struct robot *r)
{
    r->console_count = 0;
    console_flush(r); /* drops the lines */
}

/* At hundreds of steps a second, a mail for each step would come faster than a person reads. */
void console_offer(struct robot *r)
{
    bool reads = r->group->trace.len >= ROBOT_ANSWER_MAX;
    for (uint32_t i = 0; i < r->console_count; i++) {
        reads = reads || r->consoles[i].unread == 0;
    }
    if (reads) {
        console_flush(r);
    }
}

bool console_print(struct robot *r, const char *text)
{
    struct group_process *group = r->group;
    if (r->console_count == 0) {
        return false;
    }
    if (group->traced && group->traced != r) {
        trace_flush(group->traced);
    }
    group->traced = r;
    if (group->trace.len + strlen(text) < group->trace.size) {
        mu_text_add(&group->trace, text);
    } else {
        group->trace_cut += strchr(text, '\n') != NULL;
    }
    return true;
}

/* --- questions of consoles ----------------------------------------------------------------------
 * */

/* Sends the listing in pieces; each says its number and how many there are. */
static void listing_send(struct robot *r, const struct mu_mail *asked, bool done)
{
    struct group_process *group = r->group;
    char of[MU_FIELD_MAX + 1];
    uint32_t count = mu_pieces_count(group->listing.at, ROBOT_ANSWER_MAX);
    const char *at = group->listing.at;
    mu_result sent = MU_OK;
    for (uint32_t i = 1; i <= count && sent == MU_OK; i++) {
        (void)mu_pieces_next(&at, group->answer, ROBOT_ANSWER_MAX);
        snprintf(of, sizeof of, "piece %u %u", i, count);
        sent = mu_agent_send(r->agent,
                             &(struct mu_mail){.dst = asked->src,
                                               .performative = done ? "inform" : "failure",
                                               .language = "text",
                                               .ontology = of,
                                               .in_reply_to = asked->reply_with,
                                               .content = group->answer},
                             NULL);
    }
    if (sent != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s why=%s", asked->src, mu_result_text(sent));
    }
}

static const char listing_cut[] = "\n[the answer is longer than 256 KiB: the rest is left out]\n";

_Static_assert((unsigned)ROBOT_LISTING_MAX <= MU_GLANCE_BYTES_MAX, "a glance shows all of it");

static void listing_end(struct mu_text *listing)
{
    if (listing->cut) {
        listing->len -= sizeof listing_cut;
        listing->at[listing->len] = '\0';
        mu_text_add(listing, listing_cut);
    }
}

bool console_answer(struct robot *r, const struct mu_mail *asked,
                    mu_result (*ask)(struct mind *m, const char *line, struct mu_text *out))
{
    struct mu_text *listing = &r->group->listing;
    console_flush(r); /* earlier lines come first */
    mu_text_clear(listing);
    bool done = ask(r->mind, asked->content, listing) == MU_OK;
    listing_end(listing);
    listing_send(r, asked, done);
    return done;
}

/* Neither a waiting percept nor a watching console notices the probe. */
enum probe_end console_look(void *self, const char *line, const char **text)
{
    struct robot *r = self;
    struct mu_text *listing = &r->group->listing;
    mu_text_clear(listing);
    mu_result looked = r->state == ROBOT_VACANT ? MU_ABSENT : mind_probe(r->mind, line, listing);
    listing_end(listing);
    *text = listing->at;
    if (looked == MU_ABSENT) {
        return PROBE_DECLINED;
    }
    return looked == MU_OK ? PROBE_DONE : PROBE_FAILED;
}

static mu_result words_list(struct mind *m, const char *line, struct mu_text *out)
{
    (void)line;
    mind_words(m, out);
    return MU_OK;
}

void console_words(struct robot *r, const struct mu_mail *asked)
{
    (void)console_answer(r, asked, words_list);
}

/* Drops the oldest console, which may be a dead one, and tells it. */
static void console_push_out(struct robot *r)
{
    struct mu_mail mail = {.dst = r->consoles[0].name,
                           .performative = "trace",
                           .language = "text",
                           .content = "[other consoles have come: this one sees no more of what is "
                                      "watched]\n"};
    if (mu_agent_send(r->agent, &mail, NULL) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", mail.dst);
    }
    r->console_count--;
    memmove(r->consoles, r->consoles + 1, r->console_count * sizeof r->consoles[0]);
}

/* @return the console of that name, as the youngest one */
static struct console *console_enter(struct robot *r, const char *name)
{
    const struct console *earlier = console_find(r, name);
    uint64_t lost = earlier ? earlier->lost : 0;
    console_leave(r, name);
    if (r->console_count == ROBOT_CONSOLES_MAX) {
        console_push_out(r);
    }
    struct console *c = &r->consoles[r->console_count++];
    *c = (struct console){.lost = lost};
    mu_text_copy(c->name, sizeof c->name, name);
    return c;
}

/* "attach N", "more N": room for N more pieces; "detach". */
void console_directive(struct robot *r, const struct mu_mail *mail)
{
    const char *count = strchr(mail->content, ' ');
    size_t len = count ? (size_t)(count - mail->content) : strlen(mail->content);
    bool attaches = len == 6 && strncmp(mail->content, "attach", len) == 0;
    if (len == 6 && strncmp(mail->content, "detach", len) == 0) {
        console_leave(r, mail->src);
        return;
    }
    struct console *c = attaches ? console_enter(r, mail->src) : console_find(r, mail->src);
    unsigned long more = count ? strtoul(count, NULL, 10) : 0;
    if (c) {
        unsigned long credit = c->credit + (more < ROBOT_CREDIT_MAX ? more : 0);
        c->credit = credit < ROBOT_CREDIT_MAX ? (uint32_t)credit : ROBOT_CREDIT_MAX;
        c->unread = 0;
        console_offer(r);
    }
    if (mail->reply_with[0] && mu_agent_reply(r->agent, mail, "inform", mail->content) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", mail->src);
    }
}
