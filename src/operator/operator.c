/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/clock.h"
#include "core/exits.h"
#include "core/fields.h"
#include "core/json.h"
#include "core/name.h"
#include "core/text.h"
#include "muster/directory.h"
#include "runtime/join.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double RECEIPT_PATIENCE_S = 5;
static const double BUSY_WAIT_S = 0.5; /* at least, for an agent that is busy */
static const int64_t ROUND_NS = 20000000;
static const uint64_t PAGES_QUIET_NS = 100000000;

/* So long a verb waits for the name that another one holds, and so long it lets it alone. */
static const uint64_t HELD_PATIENCE_NS = 10000000000;
static const uint64_t HELD_PAUSE_NS = 200000000;

/* So many lines are in one Delivery, whatever they are. */
enum { PAGES_SHORT = 1024 };

mu_result operator_parse(struct mu_options *o, int argc, char **argv,
                         struct operator_options *options)
{
    options->network.domain = -1;
    return mu_options_parse(o, argc, argv);
}

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct operator* o = self;
    o->registered = accepted;
    o->refused = !accepted;
    (void)a;
    mu_text_copy(o->reason, sizeof o->reason, accepted ? "" : reason);
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)a;
    struct operator* o = self;
    if (o->hooks) {
        o->hooks->on_receipt(o->hooks->self, first_seq, last_seq, outcome);
    }
    if (first_seq <= o->seq && o->seq <= last_seq) {
        o->outcome = outcome;
        o->answered_for = true;
    }
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct operator* o = self;
    if (o->hooks) {
        o->hooks->on_mail(o->hooks->self, mail);
    }
    if (!o->reply_with || strcmp(mail->in_reply_to, o->reply_with) != 0) {
        return;
    }
    if (o->asks_many && strcmp(mail->performative, "not-understood") == 0) {
        return; /* a member of a group need not know CLIPS */
    }
    o->answers++;
    int code = answer_exit(mail);
    bool counts = code != MU_EXIT_DONE && (o->failure_code == 0 || code < o->failure_code);
    o->failure_code = counts ? code : o->failure_code;
    if (o->on_answer) {
        o->on_answer(o->on_answer_self, mail);
    } else {
        answer_print(mail, o->json);
    }
}

/* @return lines of all pages together */
static size_t lines_count(const mu_process *p)
{
    size_t count = 0, groups = 0, offers = 0;
    const char *group;
    while (mu_process_member(p, count)) {
        count++;
    }
    for (; (group = mu_process_group(p, groups)); groups++) {
        size_t members = 0;
        while (mu_process_group_member(p, group, members)) {
            members++;
        }
        count += members;
    }
    while (mu_process_find_service(p, "*", offers)) {
        offers++;
    }
    return count + groups + offers;
}

/* The broker's first word has all pages in it, unless they are long: then more follows at once. */
static void pages_await(mu_process *p)
{
    size_t before = 0, count = lines_count(p);
    while (count != before && count >= PAGES_SHORT) {
        before = count;
        uint64_t until_ns = mu_clock_ns() + PAGES_QUIET_NS;
        while (mu_clock_ns() < until_ns && mu_process_spin(p, ROUND_NS) == MU_OK) {
        }
        count = lines_count(p);
    }
}

/* --- joining ---------------------------------------------------------------------------------- */

/* attempt: readers have one name after another, until one is free */
static void agent_join(struct operator* o, const struct operator_options *options, unsigned attempt)
{
    char name[MU_NAME_MAX + 1];
    if (options->as || !options->only_reads) {
        mu_text_copy(name, sizeof name, options->as ? options->as : "operator");
    } else {
        reader_name(name, attempt, options->stays);
    }
    enum mu_kind kind = options->as ? MU_KIND_AGENT : MU_KIND_SPECIAL;
    struct mu_handlers handlers = {
        .self = o, .on_registered = on_registered, .on_mail = on_mail, .on_receipt = on_receipt};
    o->registered = o->refused = false;
    mu_result joined = mu_agent_join(o->process, &o->agent, name, kind, 0, &handlers);
    MU_ASSERT(joined == MU_OK); /* the name is good, and an earlier one of ours has left */
    mu_agent_decline_broadcasts(o->agent);
    if (options->takes_no_mail) {
        mu_agent_set_state(o->agent, MU_MOVING);
    }
}

/* Spins until the broker has said something of our name, or that takes too long. */
static void verdict_await(struct operator* o, uint64_t patience_ns)
{
    uint64_t until_ns = mu_clock_ns() + patience_ns;
    while (!o->registered && !o->refused && mu_clock_ns() < until_ns &&
           mu_process_spin(o->process, ROUND_NS) == MU_OK) {
    }
}

static bool is_held(const struct operator* o)
{
    return o->refused && mu_agent_refusal(o->agent) == MU_REFUSAL_NAME_HELD;
}

/* Tries again while another verb has our name.  @return the exit code, explained */
static int name_await(struct operator* o, const struct operator_options *options, const char *verb)
{
    uint64_t until_ns = mu_clock_ns() + HELD_PATIENCE_NS;
    bool is_said = options->only_reads;
    for (unsigned attempt = 1; !options->as && is_held(o) && mu_clock_ns() < until_ns; attempt++) {
        if (!is_said) {
            fprintf(stderr, "muster %s: another verb is the operator now; waiting for it\n", verb);
            is_said = true;
        }
        mu_agent_set_state(o->agent, MU_GONE);
        uint64_t pause_ns = mu_clock_ns() + HELD_PAUSE_NS;
        while (mu_clock_ns() < pause_ns && mu_process_spin(o->process, ROUND_NS) == MU_OK) {
        }
        agent_join(o, options, attempt);
        verdict_await(o, mu_network_wait_ns(&options->network));
    }
    if (o->refused) {
        fprintf(stderr, "muster: the broker refuses the name %s: %s\n", mu_agent_name(o->agent),
                o->reason);
        return MU_EXIT_REFUSED;
    }
    return MU_EXIT_DONE;
}

int operator_join(struct operator* o, const struct operator_options *options, const char *verb)
{
    int domain = (int)options->network.domain;
    *o = (struct operator){.json = options->json, .quiet = options->quiet, .hooks = options->hooks};
    if (domain < 0 && runs_find(&domain) != MU_OK) {
        return MU_EXIT_SEVERAL;
    }
    struct mu_process_options process = join_options(&options->network, "operator");
    process.domain = domain ? domain : MU_DOMAIN_ZERO;
    if (options->as && !words_name_check("muster", "an agent", options->as)) {
        return MU_EXIT_USAGE;
    }
    mu_result opened = mu_process_open(&o->process, &process);
    if (opened != MU_OK) {
        return mu_exit_for(opened);
    }
    agent_join(o, options, 0);
    char program[64];
    snprintf(program, sizeof program, "muster %s", verb);
    if (join_await(o->process, &options->network, program, domain) != MU_OK) {
        runs_tell_last(program, (int)options->network.domain);
        return MU_EXIT_DDS;
    }
    pages_await(o->process);
    return name_await(o, options, verb);
}

void operator_leave(struct operator* o)
{
    if (mu_name_of_operator(mu_agent_name(o->agent))) {
        mu_agent_set_state(o->agent, MU_GONE); /* nothing is for a reader when it is gone */
    }
    mu_process_close(o->process);
}

const struct mu_member *operator_busy(const struct operator* o, const char *to)
{
    const struct mu_member *m = mu_process_lookup(o->process, to);
    return m && m->busy_since_wall_ns > 0 ? m : NULL;
}

static bool busy_tell(const struct operator* o, const char *to)
{
    const struct mu_member *m = operator_busy(o, to);
    if (m) {
        fprintf(stderr, "muster: %s is %s\n", m->name, m->reason);
    }
    return m;
}

/* Directives reach the suspended at once. */
static void absence_tell(const struct operator* o, const struct mu_mail *mail)
{
    const struct mu_member *m = mu_process_lookup(o->process, mail->dst);
    if (m && (m->state == MU_GONE || (m->state == MU_SUSPENDED && !mail->directive))) {
        fprintf(stderr, "muster: %s is %s; what was sent waits for it\n", m->name,
                mu_state_text(m->state));
    }
}

/* Waits for as long as a broker may take; for an agent that is busy, as long as that is wanted.
 * @return false: in vain */
static bool outcome_await(struct operator* o, const char *to, double wait_s)
{
    uint64_t began_ns = mu_clock_ns();
    while (!o->answered_for) {
        double most_s = operator_busy(o, to) ? fmax(wait_s, BUSY_WAIT_S) : RECEIPT_PATIENCE_S;
        bool over = (double)(mu_clock_ns() - began_ns) > most_s * 1e9;
        if (over || mu_process_spin(o->process, ROUND_NS) != MU_OK) {
            return false;
        }
    }
    return true;
}

/* Waits for answers as long as any may come. */
static void answers_await(struct operator* o, unsigned wanted, uint64_t patience_ns)
{
    uint64_t until_ns = mu_clock_ns() + patience_ns;
    while (o->answers < wanted && answer_outcome_exit(o->outcome) == MU_EXIT_DONE &&
           mu_clock_ns() <= until_ns && mu_process_spin(o->process, ROUND_NS) == MU_OK) {
    }
}

void operator_outcome_print(const char *to, uint64_t seq, const char *outcome, int code)
{
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "to", to);
    mu_json_uint(&j, "seq", seq);
    mu_json_string(&j, "outcome", outcome);
    if (code >= 0) {
        mu_json_uint(&j, "exit", (uint64_t)code);
    }
    mu_json_end(&j);
}

static void outcome_print(const struct operator* o, const char *to)
{
    operator_outcome_print(to, o->seq, mu_outcome_text(o->outcome), -1);
}

/* Says what became of the mail, if that is no good.  @return the exit code */
static int outcome_tell(const struct operator* o, const char *to)
{
    int code = answer_outcome_exit(o->outcome);
    if (code != MU_EXIT_DONE && o->json) {
        outcome_print(o, to);
    }
    if (code != MU_EXIT_DONE) {
        fprintf(stderr, "muster: to %s: %s%s\n", to, mu_outcome_text(o->outcome),
                answer_outcome_advice(o->outcome, to));
    }
    return code;
}

static void outcome_say(const struct operator* o, const char *to)
{
    if (o->json) {
        outcome_print(o, to);
    } else {
        printf("%s\n", mu_outcome_text(o->outcome));
    }
}

/* @return the exit code */
static int answers_take(struct operator* o, const struct mu_mail *mail, unsigned wanted,
                        double wait_s)
{
    const char *to = mail->dst;
    answers_await(o, wanted, (uint64_t)(wait_s * 1e9));
    int code = outcome_tell(o, to);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    if (o->answers < wanted && !(o->quiet && o->answers > 0)) {
        fprintf(stderr, "muster: %u of %u answers within %g s\n", o->answers, wanted, wait_s);
        (void)busy_tell(o, to);
        absence_tell(o, mail);
    }
    if (o->answers < wanted && !(o->asks_many && o->answers > 0)) {
        return MU_EXIT_TIME;
    }
    return o->failure_code;
}

int operator_send(struct operator* o, struct mu_mail *mail, unsigned answers_wanted, double wait_s)
{
    if (answers_wanted > 0 && !(mail->reply_with && mail->reply_with[0])) {
        snprintf(o->reply_with_own, sizeof o->reply_with_own, "q%ld", (long)getpid());
        mail->reply_with = o->reply_with_own;
    }
    o->reply_with = answers_wanted > 0 ? mail->reply_with : NULL;
    o->asks_many = receivers_are_many(mail->dst);
    mu_result sent = mu_agent_send(o->agent, mail, &o->seq);
    if (sent != MU_OK) {
        fprintf(stderr,
                "muster: the mail cannot be sent: %s (content up to %d bytes, receivers up "
                "to %d)\n",
                mu_result_text(sent), MU_CONTENT_MAX, MU_DST_MAX);
        return MU_EXIT_USAGE;
    }
    if (!outcome_await(o, mail->dst, wait_s)) {
        if (busy_tell(o, mail->dst)) {
            return MU_EXIT_TIME;
        }
        fprintf(stderr, "muster: the broker has not answered for the mail\n");
        return MU_EXIT_DDS;
    }
    int code = outcome_tell(o, mail->dst);
    if (code == MU_EXIT_DONE && answers_wanted > 0) {
        return answers_take(o, mail, answers_wanted, wait_s);
    }
    if (code == MU_EXIT_DONE && !o->quiet) {
        outcome_say(o, mail->dst);
    }
    return code;
}

/* --- looking ---------------------------------------------------------------------------------- */

static void look_print(const struct operator* o, const char *agent, bool good, const char *text)
{
    static char bytes[2 * MU_GLANCE_BYTES_MAX + 3]; /* each byte may be escaped */
    struct mu_text quoted = mu_text_in(bytes, sizeof bytes);
    mu_fields_quote(&quoted, text);
    struct mu_mail mail = {.src = agent,
                           .dst = mu_agent_name(o->agent),
                           .layer = MU_LAYER_SPEECH,
                           .performative = good ? "inform" : "failure",
                           .language = "",
                           .ontology = "",
                           .reply_with = "",
                           .in_reply_to = "",
                           .conversation = "",
                           .content = quoted.at};
    answer_print(&mail, o->json);
}

struct look {
    struct operator* o;
    const char *agent;
};

static void on_glance(void *self, uint64_t number, enum probe_end end, const char *text)
{
    const struct look *look = self;
    if (number != look->o->glance) {
        return;
    }
    look->o->glance = 0;
    look->o->looked = end;
    if (end != PROBE_DECLINED) {
        look_print(look->o, look->agent, end == PROBE_DONE, text);
    }
}

int operator_look(struct operator* o, const char *agent, const char *line, double wait_s)
{
    struct look look = {o, agent};
    uint64_t until_ns = mu_clock_ns() + (uint64_t)(wait_s * 1e9);
    probes_hear(o->agent, on_glance, &look);
    if (probes_ask(o->agent, agent, line, &o->glance) != MU_OK) {
        return -1;
    }
    while (o->glance && mu_clock_ns() <= until_ns &&
           mu_process_spin(o->process, ROUND_NS) == MU_OK) {
    }
    probes_hear(o->agent, NULL, NULL);
    if (o->glance) {
        fprintf(stderr, "muster: 0 of 1 answers within %g s\n", wait_s);
        (void)busy_tell(o, agent);
        return MU_EXIT_TIME;
    }
    if (o->looked == PROBE_DECLINED) {
        return -1;
    }
    return o->looked == PROBE_DONE ? MU_EXIT_DONE : MU_EXIT_UNDELIVERED;
}
