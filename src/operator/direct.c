/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/address.h"
#include "core/clock.h"
#include "core/exits.h"
#include "core/json.h"
#include "core/text.h"
#include "muster/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double RECEIPT_PATIENCE_S = 5;
static const double BUSY_WAIT_S = 0.5; /* at least, for an agent that is busy */
static const int64_t ROUND_NS = 20000000;

enum target_state {
    TARGET_NEW,
    TARGET_SENT,
    TARGET_TAKEN, /* its broker has answered for the mail */
    TARGET_ENDED
};

struct target {
    char name[MU_NAME_MAX + 1];
    enum target_state state;
    bool awaited; /* false: a member of a group that is away */
    uint64_t seq;
    int code;
};

/* Of the one directive of this process. */
static struct {
    struct target *targets;
    size_t count;
    const struct direct *what;
    struct operator* op;
    char reply_with[32];
} directing;

/* --- the receivers ---------------------------------------------------------------------------- */

bool direct_is_possible(const char *to)
{
    return mu_address_kind(to) != MU_ADDRESS_SCHEME;
}

static void target_add(const char *name, bool awaited)
{
    for (size_t i = 0; i < directing.count; i++) {
        if (strcmp(directing.targets[i].name, name) == 0) {
            return;
        }
    }
    struct target *t = &directing.targets[directing.count++];
    *t = (struct target){.awaited = awaited};
    mu_text_copy(t->name, sizeof t->name, name);
}

static void targets_find(const struct operator* o, const char *to)
{
    char name[MU_NAME_MAX + 1];
    const struct mu_member *m;
    enum mu_address_kind kind = mu_address_kind(to);
    directing.targets = mu_startup_array(MU_AGENTS_MAX, sizeof *directing.targets);
    while (kind == MU_ADDRESS_NAMES && *to && mu_address_next(&to, name)) {
        target_add(name, true);
    }
    for (size_t i = 0; kind != MU_ADDRESS_NAMES && (m = mu_process_member(o->process, i)); i++) {
        bool is_meant = receivers_have(o->process, to, m) && !reader_is(m) &&
                        strcmp(m->name, mu_agent_name(o->agent)) != 0;
        if (is_meant && (m->state != MU_GONE || kind == MU_ADDRESS_GROUP)) {
            target_add(m->name, m->state != MU_GONE);
        }
    }
}

/* --- what becomes of it ----------------------------------------------------------------------- */

static void target_end(struct target *t, int code)
{
    t->state = TARGET_ENDED;
    t->code = code;
}

static void target_receipt(struct target *t, enum mu_outcome outcome)
{
    int code = answer_outcome_exit(outcome);
    const char *text = mu_outcome_text(outcome);
    bool waits = directing.what->may_wait && outcome == MU_MAIL_STORED;
    t->state = TARGET_TAKEN;
    if (code == MU_EXIT_DONE && !waits) {
        return;
    }
    target_end(t, code);
    if (code != MU_EXIT_DONE) {
        fprintf(stderr, "muster: to %s: %s%s\n", t->name, text,
                answer_outcome_advice(outcome, t->name));
    } else if (!directing.op->json && !directing.op->quiet) {
        printf("%s: %s\n", t->name, text);
    }
    if (directing.op->json) {
        operator_outcome_print(t->name, t->seq, text, t->code);
    }
}

static void on_receipt(void *self, uint64_t first_seq, uint64_t last_seq, enum mu_outcome outcome)
{
    (void)self;
    for (size_t i = 0; i < directing.count; i++) {
        struct target *t = &directing.targets[i];
        bool waits = t->state == TARGET_SENT || t->state == TARGET_TAKEN;
        if (waits && first_seq <= t->seq && t->seq <= last_seq) {
            target_receipt(t, outcome);
        }
    }
}

static void on_mail(void *self, const struct mu_mail *mail)
{
    (void)self;
    size_t i = 0;
    while (i < directing.count && strcmp(directing.targets[i].name, mail->src) != 0) {
        i++;
    }
    if (i == directing.count || directing.targets[i].state == TARGET_ENDED ||
        strcmp(mail->in_reply_to, directing.reply_with) != 0) {
        return;
    }
    target_end(&directing.targets[i], answer_exit(mail));
    bool is_dull = strcmp(mail->performative, "agree") == 0 && directing.op->quiet;
    if (!is_dull) {
        answer_print(mail, directing.op->json);
    }
}

static const struct operator_hooks hooks = {.on_mail = on_mail, .on_receipt = on_receipt};

void direct_hear(struct operator_options *options)
{
    options->hooks = &hooks;
}

/* --- sending, waiting ------------------------------------------------------------------------- */

/* As many as there is room for.  @return MU_OK, or the fault of one that can never be sent */
static mu_result targets_tell(struct operator* o)
{
    for (size_t i = 0; i < directing.count; i++) {
        struct target *t = &directing.targets[i];
        struct mu_mail mail = {.dst = t->name,
                               .directive = true,
                               .performative = directing.what->performative,
                               .reply_with = directing.reply_with,
                               .content = directing.what->content};
        mu_result sent = t->state == TARGET_NEW ? mu_agent_send(o->agent, &mail, &t->seq) : MU_OK;
        if (sent != MU_OK) {
            return sent == MU_FULL ? MU_OK : sent;
        }
        t->state = t->state == TARGET_NEW ? TARGET_SENT : t->state;
    }
    return MU_OK;
}

static bool target_waits(const struct operator* o, const struct target *t, double passed_s)
{
    bool is_heard = t->state == TARGET_TAKEN || operator_busy(o, t->name);
    double most_s = fmax(directing.what->wait_s, is_heard ? BUSY_WAIT_S : RECEIPT_PATIENCE_S);
    return t->state != TARGET_ENDED && passed_s < most_s &&
           (t->awaited || t->state != TARGET_TAKEN);
}

static bool any_waits(const struct operator* o, double passed_s)
{
    size_t i = 0;
    while (i < directing.count && !target_waits(o, &directing.targets[i], passed_s)) {
        i++;
    }
    return i < directing.count;
}

/* What is known of an agent that does not answer. */
static void silence_tell(const struct operator* o, struct target *t)
{
    const struct mu_member *m = mu_process_lookup(o->process, t->name);
    bool is_busy = operator_busy(o, t->name);
    bool is_lost = t->state != TARGET_TAKEN && !is_busy;
    target_end(t, is_lost ? MU_EXIT_DDS : MU_EXIT_TIME);
    if (o->json) {
        operator_outcome_print(t->name, t->seq, "silent", t->code);
    }
    if (is_lost) {
        fprintf(stderr, "muster: to %s: the broker has not answered for the mail\n", t->name);
    } else if (is_busy) {
        fprintf(stderr, "muster: %s is %s\n", t->name, m->reason);
    } else if (m && m->state == MU_GONE) {
        fprintf(stderr, "muster: %s is absent; what was sent waits for it\n", t->name);
    } else {
        fprintf(stderr, "muster: %s: no answer within %g s\n", t->name, directing.what->wait_s);
    }
}

/* --- all of them ------------------------------------------------------------------------------ */

/* @return the smallest code of a receiver that did not do it */
static int targets_end(const struct operator* o)
{
    int code = MU_EXIT_DONE;
    uint64_t done = 0, refused = 0, silent = 0;
    for (size_t i = 0; i < directing.count; i++) {
        struct target *t = &directing.targets[i];
        if (t->state != TARGET_ENDED) {
            silence_tell(o, t);
        }
        done += t->code == MU_EXIT_DONE;
        refused += t->code == MU_EXIT_REFUSED;
        silent += t->code == MU_EXIT_TIME || t->code == MU_EXIT_DDS;
        code = t->code != MU_EXIT_DONE && (code == MU_EXIT_DONE || t->code < code) ? t->code : code;
    }
    if (o->json && (directing.count > 1 || receivers_are_many(directing.what->to))) {
        struct mu_json j = mu_json_line(stdout);
        mu_json_uint(&j, "receivers", directing.count);
        mu_json_uint(&j, "done", done);
        mu_json_uint(&j, "refused", refused);
        mu_json_uint(&j, "failed", directing.count - done - refused - silent);
        mu_json_uint(&j, "silent", silent);
        mu_json_uint(&j, "exit", (uint64_t)code);
        mu_json_end(&j);
    }
    return code;
}

int direct_send(struct operator* o, const struct direct *d)
{
    directing.what = d;
    directing.op = o;
    snprintf(directing.reply_with, sizeof directing.reply_with, "q%ld", (long)getpid());
    targets_find(o, d->to);
    if (directing.count == 0) {
        fprintf(stderr, "muster: to %s: no such agent is there; muster ps lists all\n", d->to);
        return MU_EXIT_NO_AGENT;
    }
    uint64_t began_ns = mu_clock_ns();
    double passed_s = 0;
    while (any_waits(o, passed_s)) {
        mu_result sent = targets_tell(o);
        if (sent != MU_OK) {
            fprintf(stderr, "muster: the mail cannot be sent: %s (content up to %d bytes)\n",
                    mu_result_text(sent), MU_CONTENT_MAX);
            return MU_EXIT_USAGE;
        }
        if (mu_process_spin(o->process, ROUND_NS) != MU_OK) {
            break;
        }
        passed_s = (double)(mu_clock_ns() - began_ns) / 1e9;
    }
    return targets_end(o);
}
