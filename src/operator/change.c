/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/clock.h"
#include "core/exits.h"
#include "core/fields.h"
#include "core/name.h"

#include <stdio.h>
#include <string.h>

static const double ANSWER_PATIENCE_S = 5.0;
static const uint64_t JOIN_PATIENCE_NS = 3000000000;
static const int64_t ROUND_NS = 20000000;

void change_add_offer(struct mu_text *t, const char *service, const char *attributes,
                      double lease_s)
{
    mu_text_add(t, service);
    mu_fields_add_string(t, attributes);
    mu_text_format(t, " %.9f", lease_s);
}

bool change_name_check(const char *program, const char *as)
{
    if (!as || strcmp(as, "operator") == 0 || strcmp(as, "observer") == 0) {
        return true;
    }
    if (!words_name_check(program, "an agent", as)) {
        return false;
    }
    if (mu_name_reserved(as)) {
        fprintf(stderr, "%s: --as %s: the name is reserved\n", program, as);
        return false;
    }
    return true;
}

/* --- an agent that joins for the moment ------------------------------------------------------- */

enum guest { GUEST_WAITS, GUEST_IN, GUEST_OUT };

static void on_guest(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)a;
    (void)reason;
    *(enum guest *)self = accepted ? GUEST_IN : GUEST_OUT;
}

/* Makes a name known.  That another took it meanwhile is as good. */
static void guest_join(struct operator* op, const char *name)
{
    static enum guest guest;
    mu_agent *agent;
    struct mu_handlers handlers = {.self = &guest, .on_registered = on_guest};
    if (mu_agent_join(op->process, &agent, name, MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        return;
    }
    mu_agent_decline_broadcasts(agent);
    mu_agent_set_state(agent, MU_MOVING); /* its mail is to wait for itself */
    uint64_t until_ns = mu_clock_ns() + JOIN_PATIENCE_NS;
    while (guest == GUEST_WAITS && mu_clock_ns() < until_ns &&
           mu_process_spin(op->process, ROUND_NS) == MU_OK) {
    }
}

/* --- the broker's word ------------------------------------------------------------------------ */

struct answer {
    bool done;
    char reason[MU_FIELD_MAX + 1];
};

static void answer_take(void *self, const struct mu_mail *mail)
{
    struct answer *a = self;
    a->done = strcmp(mail->performative, "inform") == 0;
    struct mu_text t = mu_text_in(a->reason, sizeof a->reason);
    mu_text_add_bytes(&t, mail->content, strcspn(mail->content, " "));
}

static int refusal_exit(enum mu_refusal code)
{
    static const struct {
        enum mu_refusal code;
        int exit;
    } exits[] = {
        {MU_REFUSAL_POLICY, MU_EXIT_REFUSED},         {MU_REFUSAL_UNKNOWN_NAME, MU_EXIT_NO_AGENT},
        {MU_REFUSAL_UNKNOWN_GROUP, MU_EXIT_NO_AGENT}, {MU_REFUSAL_NOT_A_MEMBER, MU_EXIT_NO_AGENT},
        {MU_REFUSAL_NOT_OFFERED, MU_EXIT_NO_AGENT},   {MU_REFUSAL_NOT_A_NAME, MU_EXIT_USAGE},
        {MU_REFUSAL_NOT_ATTRIBUTES, MU_EXIT_USAGE}};
    size_t i = 0;
    while (i < sizeof exits / sizeof exits[0] && exits[i].code != code) {
        i++;
    }
    return i < sizeof exits / sizeof exits[0] ? exits[i].exit : MU_EXIT_UNDELIVERED;
}

static int refusal_tell(const char *program, const char *reason)
{
    enum mu_refusal code = mu_refusal_named(reason);
    fprintf(stderr, "%s: %s; %s\n", program, reason,
            code != MU_REFUSAL_NONE ? mu_refusal_text(code) : "the broker refuses it");
    return refusal_exit(code);
}

int change_make(struct operator* op, const struct operator_options *options, const struct change *c)
{
    char content[2 * MU_ATTRIBUTES_MAX + 4 * MU_NAME_MAX];
    struct answer answer = {.done = false};
    struct operator_options own = *options;
    own.as = NULL;
    int code = operator_join(op, &own, c->program + strlen("muster "));
    if (code != MU_EXIT_DONE) {
        return code;
    }
    struct mu_text t = mu_text_in(content, sizeof content);
    mu_text_add(&t, c->content);
    if (options->as && !c->of_nobody) {
        mu_text_format(&t, " %s", options->as);
        if (!mu_process_lookup(op->process, options->as)) {
            guest_join(op, options->as);
        }
    }
    MU_ASSERT(!t.cut);
    struct mu_mail mail = {.dst = "broker",
                           .layer = MU_LAYER_QUERY,
                           .performative = c->performative,
                           .content = content};
    op->on_answer = answer_take;
    op->on_answer_self = &answer;
    code = operator_send(op, &mail, 1, ANSWER_PATIENCE_S);
    if (op->answers == 0) {
        return code;
    }
    return answer.done ? MU_EXIT_DONE : refusal_tell(c->program, answer.reason);
}
