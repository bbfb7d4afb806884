/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The console of the global controller: its lines become directives to each agent that they are
 * for, and each agent's answer, or what became of its directive, one line of the console's answer.
 */
#include "core/clock.h"
#include "core/exits.h"
#include "core/fields.h"
#include "core/name.h"
#include "core/pieces.h"
#include "muster/directory.h"
#include "muster/kind.h"
#include "muster/memory.h"
#include "operator/operator.h"
#include "run/observer.h"
#include "run/run.h"

#include <stdio.h>
#include <string.h>

static const uint64_t PATIENCE_NS = 5000000000;

/* Where no more glances may be under way, a line that only looks waits so long before it goes as a
 * directive. */
static const uint64_t GLANCE_PATIENCE_NS = 500000000;

enum {
    ORDERS_MAX = 8,              /* lines that wait for answers */
    TARGETS_MAX = MU_ROBOTS_MAX, /* agents that one line is for */
    ANSWER_BYTES = 128 * 1024,   /* of one line's answer */
    PIECE_BYTES = MU_CONTENT_MAX / 2
};

struct target {
    char name[MU_NAME_MAX + 1];
    uint64_t seq;    /* of the directive; 0: it has not gone out */
    uint64_t glance; /* number of the question, if it only looks; 0: it has not gone out */
    bool declined;   /* it looks in vain: a directive it is */
    bool ended;      /* its line of the answer is written */
};

struct order {
    bool used;
    uint64_t number;
    uint64_t since_ns;
    struct observer_order what;
    char asker[MU_NAME_MAX + 1], label[MU_FIELD_MAX + 1];
    bool in_pieces;
    struct target targets[TARGETS_MAX];
    size_t targets_count;
    unsigned failures;
    struct mu_text answer;
    char answer_bytes[ANSWER_BYTES];
};

struct run_observer {
    struct order orders[ORDERS_MAX];
    uint64_t number; /* of the last order */
    char text[MU_CONTENT_MAX + 1];
    char line[MU_CONTENT_MAX + 64];
};

void run_observer_open(struct run *r)
{
    r->console = mu_startup_alloc(sizeof *r->console);
}

/* --- answers to the console ------------------------------------------------------------------- */

static void answer_send(struct run *r, const struct order *o)
{
    char of[MU_FIELD_MAX + 1];
    const char *at = o->answer.at;
    uint32_t count = o->in_pieces ? mu_pieces_count(at, PIECE_BYTES) : 1;
    struct mu_text quoted;
    mu_result sent = MU_OK;
    for (uint32_t i = 1; i <= count && sent == MU_OK; i++) {
        snprintf(of, sizeof of, o->in_pieces ? "piece %u %u" : "", i, count);
        (void)mu_pieces_next(&at, r->console->text, PIECE_BYTES);
        struct mu_mail mail = {.dst = o->asker,
                               .performative = o->failures > 0 ? "failure" : "inform",
                               .language = o->in_pieces ? "text" : "",
                               .ontology = of,
                               .in_reply_to = o->label,
                               .content = r->console->text};
        mu_text_init(&quoted, r->console->line, MU_CONTENT_MAX + 1);
        mu_fields_quote(&quoted, r->console->text);
        mail.content = o->in_pieces ? mail.content : quoted.at;
        sent = mu_agent_send(r->observer, &mail, NULL);
    }
    if (sent != MU_OK) {
        fprintf(stderr, "muster run: an answer to %s is lost: %s\n", o->asker,
                mu_result_text(sent));
    }
}

static void order_end(struct run *r, struct order *o)
{
    if (o->answer.cut) {
        o->answer.len -= 64;
        o->answer.at[o->answer.len] = '\0';
        mu_text_add(&o->answer, "\n[the rest of the answer is left out]\n");
    }
    if (o->label[0]) {
        answer_send(r, o);
    }
    o->used = false;
}

static void target_end(struct order *o, struct target *t, bool good, const char *what)
{
    if (t->ended) {
        return;
    }
    t->ended = true;
    o->failures += !good;
    size_t len = strlen(what);
    mu_text_format(&o->answer, "%s: %s%s", t->name, what, len && what[len - 1] == '\n' ? "" : "\n");
}

/* --- the receivers of a line ------------------------------------------------------------------ */

static void target_add(struct order *o, const char *name)
{
    for (size_t i = 0; i < o->targets_count; i++) {
        if (strcmp(o->targets[i].name, name) == 0) {
            return;
        }
    }
    if (o->targets_count < TARGETS_MAX) {
        struct target *t = &o->targets[o->targets_count++];
        *t = (struct target){.seq = 0};
        mu_text_copy(t->name, sizeof t->name, name);
    }
}

static void wide_add(const struct run *r, struct order *o, const char *to)
{
    const struct mu_member *m;
    for (size_t i = 0; (m = mu_process_member(r->process, i)); i++) {
        bool is_self = strcmp(m->name, "observer") == 0 || mu_name_of_operator(m->name);
        if (!is_self && receivers_have(r->process, to, m)) {
            target_add(o, m->name);
        }
    }
}

static void service_add(const struct run *r, struct order *o, const char *query)
{
    const struct mu_service *s;
    for (size_t i = 0; (s = mu_process_find_service(r->process, query, i)); i++) {
        target_add(o, s->agent);
    }
}

/* One word of WHO.  A name that is no agent's may be a group's. */
static void who_add(struct run *r, struct order *o, const char *who)
{
    char group[MU_NAME_MAX + sizeof "group:"] = "group:";
    bool wide = strcmp(who, "all") == 0 || strcmp(who, "robots") == 0 ||
                strcmp(who, "special") == 0 || strncmp(who, "group:", 6) == 0;
    if (wide) {
        wide_add(r, o, who);
    } else if (strncmp(who, "service:", 8) == 0) {
        service_add(r, o, who + 8);
    } else if (!mu_name_valid(who)) {
        mu_text_format(&o->answer,
                       "%s: expected a name, all, robots, special, group:G or "
                       "service:S\n",
                       who);
        o->failures++;
    } else if (!mu_process_lookup(r->process, who) && receivers_are_group(r->process, who)) {
        mu_text_copy(group + 6, sizeof group - 6, who);
        wide_add(r, o, group);
    } else {
        target_add(o, who);
    }
}

static void targets_find(struct run *r, struct order *o)
{
    char word[MU_DST_MAX + 1];
    const char *at = o->what.who;
    while (*at) {
        size_t len = strcspn(at, ",");
        snprintf(word, sizeof word, "%.*s", (int)len, at);
        who_add(r, o, word);
        at += len + (at[len] == ',');
    }
    if (o->targets_count == 0 && o->failures == 0) {
        mu_text_format(&o->answer, "%s: no agent\n", o->what.who);
        o->failures++;
    }
}

/* --- what goes out ---------------------------------------------------------------------------- */

/* @return whether a line that only looks is asked as such, or waits for room */
static bool target_look(struct run *r, const struct order *o, struct target *t, bool *room)
{
    if (t->declined || strcmp(o->what.performative, "do") != 0) {
        return false;
    }
    mu_result asked = probes_ask(r->observer, t->name, o->what.content, &t->glance);
    bool waits = asked == MU_FULL && mu_clock_ns() - o->since_ns < GLANCE_PATIENCE_NS;
    *room = !waits;
    return asked == MU_OK || waits;
}

/* @return false: no room for it just now */
static bool target_tell(struct run *r, struct order *o, struct target *t)
{
    char label[MU_FIELD_MAX + 1];
    const struct mu_member *m = mu_process_lookup(r->process, t->name);
    if (!m || m->state == MU_GONE) {
        target_end(o, t, false, m ? "absent" : "no such agent");
        return true;
    }
    bool room;
    if (target_look(r, o, t, &room)) {
        return room;
    }
    snprintf(label, sizeof label, "console-%llu-%zu", (unsigned long long)o->number,
             (size_t)(t - o->targets));
    struct mu_mail mail = {.dst = t->name,
                           .directive = true,
                           .performative = o->what.performative,
                           .reply_with = label,
                           .content = o->what.content};
    return mu_agent_send(r->observer, &mail, &t->seq) == MU_OK;
}

static void agents_list(const struct run *r, struct mu_text *out)
{
    const struct mu_member *m;
    for (size_t i = 0; (m = mu_process_member(r->process, i)); i++) {
        mu_text_format(out, "%s %s %s\n", m->name, mu_kind_text(m->kind), mu_state_text(m->state));
    }
}

static struct order *order_take(struct run *r, const struct mu_mail *mail)
{
    for (size_t i = 0; i < ORDERS_MAX; i++) {
        struct order *o = &r->console->orders[i];
        if (!o->used) {
            o->used = true;
            o->number = ++r->console->number;
            o->since_ns = mu_clock_ns();
            o->targets_count = o->failures = 0;
            o->in_pieces = strcmp(mail->ontology, "console") == 0;
            mu_text_copy(o->asker, sizeof o->asker, mail->src);
            mu_text_copy(o->label, sizeof o->label, mail->reply_with);
            mu_text_init(&o->answer, o->answer_bytes, sizeof o->answer_bytes);
            return o;
        }
    }
    return NULL;
}

static void line_do(struct run *r, struct order *o, const char *line)
{
    if (r->state != muster_RUN_RUNNING) {
        mu_text_add(&o->answer, "the run has not begun, or is over\n");
        o->failures++;
    } else if (observer_read(&o->what, line, &o->answer) != MU_OK) {
        o->failures++;
    } else if (o->what.answer == OBSERVER_HERE) {
        agents_list(r, &o->answer);
    } else {
        targets_find(r, o);
    }
}

void run_observer_directive(struct run *r, const struct mu_mail *mail)
{
    bool is_line = strcmp(mail->performative, "do") == 0;
    bool is_words = strcmp(mail->performative, "words") == 0;
    struct order *o = is_line || is_words ? order_take(r, mail) : NULL;
    if (o && is_line) {
        line_do(r, o, mail->content);
    } else if (o) {
        observer_words(&o->answer);
    } else if (mail->reply_with[0]) {
        bool is_console = strcmp(mail->performative, "console") == 0;
        const char *why = is_line ? "8 lines are under way" : mail->performative;
        if (mu_agent_reply(r->observer, mail, is_console ? "inform" : "refuse", why) != MU_OK) {
            fprintf(stderr, "muster run: an answer to %s is lost\n", mail->src);
        }
    }
}

/* --- what comes back -------------------------------------------------------------------------- */

/* The target that a label names.  @return NULL: none that still waits */
static struct target *target_find(struct run *r, const char *label, struct order **order)
{
    unsigned long long number;
    size_t index;
    if (sscanf(label, "console-%llu-%zu", &number, &index) != 2) {
        return NULL;
    }
    for (size_t i = 0; i < ORDERS_MAX; i++) {
        struct order *o = &r->console->orders[i];
        if (o->used && o->number == number && index < o->targets_count) {
            *order = o;
            return &o->targets[index];
        }
    }
    return NULL;
}

/* What an agent printed. */
static void target_answer(struct run *r, struct order *o, struct target *t, bool good,
                          const char *printed)
{
    struct mu_text said = mu_text_in(r->console->line, sizeof r->console->line);
    mu_text_format(&said, "%s: %s", good ? "done" : "failed", printed);
    target_end(o, t, good, said.at);
}

bool run_observer_take(struct run *r, const struct mu_mail *mail)
{
    if (strncmp(mail->in_reply_to, "console-", 8) != 0) {
        return false;
    }
    struct order *o = NULL;
    struct target *t = target_find(r, mail->in_reply_to, &o);
    if (!t || strcmp(t->name, mail->src) != 0) {
        return true; /* too late */
    }
    bool fails = answer_is_failure(mail);
    const char *content = mail->content;
    if (strcmp(mail->performative, "agree") == 0) {
        target_end(o, t, true, "done");
        return true;
    }
    if (strcmp(mail->performative, "refuse") == 0) {
        target_answer(r, o, t, false, content);
        return true;
    }
    struct mu_text printed = mu_text_in(r->console->text, sizeof r->console->text);
    (void)mu_fields_next(&content, &printed); /* one string */
    target_answer(r, o, t, !fails, r->console->text);
    return true;
}

static void probe_end(struct run *r, struct order *o, struct target *t, enum probe_end end,
                      const char *text)
{
    t->glance = 0;
    t->declined = true;
    if (end != PROBE_DECLINED) {
        target_answer(r, o, t, end == PROBE_DONE, text);
    }
}

void run_observer_glance(void *self, uint64_t number, enum probe_end end, const char *text)
{
    struct run *r = self;
    for (size_t i = 0; i < ORDERS_MAX; i++) {
        struct order *o = &r->console->orders[i];
        for (size_t k = 0; o->used && k < o->targets_count; k++) {
            if (o->targets[k].glance == number) {
                probe_end(r, o, &o->targets[k], end, text);
                return;
            }
        }
    }
}

/* What a receipt says of one directive.  @return whether that is the end of it */
static void target_receipt(struct order *o, struct target *t, enum mu_outcome outcome)
{
    if (outcome == MU_MAIL_REFUSED) {
        target_end(o, t, false, "refused by the trust policy");
    } else if (answer_outcome_exit(outcome) != MU_EXIT_DONE) {
        target_end(o, t, false, mu_outcome_text(outcome));
    }
}

uint64_t run_observer_receipt(struct run *r, uint64_t first_seq, uint64_t last_seq,
                              enum mu_outcome outcome)
{
    uint64_t count = 0;
    for (size_t i = 0; i < ORDERS_MAX; i++) {
        struct order *o = &r->console->orders[i];
        for (size_t k = 0; o->used && k < o->targets_count; k++) {
            struct target *t = &o->targets[k];
            if (t->seq >= first_seq && t->seq <= last_seq && t->seq > 0) {
                target_receipt(o, t, outcome);
                count++;
            }
        }
    }
    return count;
}

/* @return whether an agent is still waited for */
static bool order_waits(struct run *r, struct order *o)
{
    bool waits = false, room = true;
    for (size_t i = 0; i < o->targets_count; i++) {
        struct target *t = &o->targets[i];
        if (!t->ended && t->seq == 0 && t->glance == 0 && room) {
            room = target_tell(r, o, t);
        }
        waits = waits || !t->ended;
    }
    return waits;
}

void run_observer_look(struct run *r)
{
    for (size_t i = 0; i < ORDERS_MAX; i++) {
        struct order *o = &r->console->orders[i];
        if (!o->used) {
            continue;
        }
        bool waits = order_waits(r, o);
        bool late = mu_clock_ns() - o->since_ns > PATIENCE_NS;
        for (size_t k = 0; waits && late && k < o->targets_count; k++) {
            target_end(o, &o->targets[k], false, "no answer");
        }
        if (!waits || late) {
            order_end(r, o);
        }
    }
}
