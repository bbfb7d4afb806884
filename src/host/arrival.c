/* SPDX-License-Identifier: Apache-2.0 */
/* Agents that arrive in pieces.  A sender's mail comes in order and once, so that the next piece is
 * known. */
#include "core/clock.h"
#include "core/log.h"
#include "host/host.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

static const uint64_t PIECE_NS = 5000000000;

void arrivals_reserve(struct host *h)
{
    for (size_t i = 0; i < HOST_ARRIVALS; i++) {
        char *bytes = mu_startup_alloc(MIGRATION_SNAPSHOT_MAX);
        mu_text_init(&h->arrivals[i].text, bytes, MIGRATION_SNAPSHOT_MAX);
    }
}

static void fill(struct arrival *a, const struct mu_mail *mail)
{
    (void)mu_text_copy(a->src, sizeof a->src, mail->src);
    (void)mu_text_copy(a->id, sizeof a->id, mail->conversation);
    (void)mu_text_copy(a->reply_with, sizeof a->reply_with, mail->reply_with);
    a->directive = mail->directive;
}

/* @return the arrival that collects the pieces of this sender, or NULL */
static struct arrival *arrival_find(struct host *h, const struct mu_mail *mail)
{
    for (size_t i = 0; i < HOST_ARRIVALS; i++) {
        struct arrival *a = &h->arrivals[i];
        if (a->used && !a->deposited && strcmp(a->src, mail->src) == 0 &&
            strcmp(a->id, mail->conversation) == 0) {
            return a;
        }
    }
    return NULL;
}

/* Begins an arrival; one whose pieces stopped coming gives way. */
static struct arrival *arrival_begin(struct host *h, const struct mu_mail *mail, size_t total)
{
    for (size_t i = 0; i < HOST_ARRIVALS; i++) {
        struct arrival *a = &h->arrivals[i];
        bool held = a->deposited && mu_process_in_lockstep(h->group.process);
        if (!a->used || (!held && mu_clock_ns() > a->until_ns)) {
            fill(a, mail);
            a->used = true;
            a->deposited = false;
            a->pieces = 0;
            a->total = total;
            mu_text_clear(&a->text);
            return a;
        }
    }
    return NULL;
}

static void refuse(struct host *h, const struct mu_mail *mail, const char *why)
{
    struct arrival a = {.used = true};
    fill(&a, mail);
    mu_log(MU_LOG_WARNING, "arrival-refused", "from=%s: %s", mail->src, why);
    host_answer(h, &a, "refuse", why);
}

static void arrival_end(struct host *h, struct arrival *a)
{
    char why[MU_FAULT_TEXT_MAX + 1];
    bool lockstep = mu_process_in_lockstep(h->group.process);
    a->used = lockstep && host_deposit(h, a, why);
    if (!a->used && (lockstep || !host_take_in(h, a, why))) {
        mu_log(MU_LOG_WARNING, "arrival-refused", "from=%s: %s", a->src, why);
        host_answer(h, a, "refuse", why);
    }
}

void arrival_take(struct host *h, const struct mu_mail *mail)
{
    unsigned number = 0;
    size_t total = 0;
    int head = 0;
    if (sscanf(mail->content, "%u %zu%n", &number, &total, &head) != 2 ||
        mail->content[head] != '\n') {
        refuse(h, mail, "expected a piece of a capsule");
        return;
    }
    if (total > (size_t)h->set->bytes || total >= MIGRATION_SNAPSHOT_MAX) {
        if (number == 0) {
            refuse(h, mail, "too-large");
        }
        return;
    }
    struct arrival *a = arrival_find(h, mail);
    a = a || number > 0 ? a : arrival_begin(h, mail, total);
    if (!a || a->pieces != number || a->total != total) {
        if (number == 0) {
            refuse(h, mail, "busy");
        }
        return;
    }
    const char *piece = mail->content + head + 1;
    mu_text_add(&a->text, piece);
    a->pieces++;
    a->until_ns = mu_clock_ns() + PIECE_NS;
    if (a->text.len >= a->total) {
        arrival_end(h, a);
    }
}
