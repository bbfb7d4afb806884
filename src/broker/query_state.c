/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/query_state.h"

#include "broker/parts.h"
#include "broker/presence.h"
#include "broker/query.h"
#include "core/text.h"

#include <inttypes.h>

void query_state_answer(struct broker *b, uint32_t own, const struct mail *question)
{
    char *content = b->text;
    struct mu_text t;
    mu_text_init(&t, content, sizeof b->text);
    if (presence_in_lockstep(b, question->sender)) {
        mu_text_add(&t, "in-lock-step");
        query_reply(b, own, question, "failure", content);
        return;
    }
    mu_text_add(&t, counters_part_name(own));
    const struct counter *c;
    for (size_t i = 0; (c = counters_at(i)); i++) {
        if (own == REGISTRY_BROKER) {
            mu_text_format(&t, " %s.%s %" PRIu64, counters_part_name(c->part), c->name,
                           counters_value(b, c));
        } else if (c->part == own) {
            mu_text_format(&t, " %s %" PRIu64, c->name, counters_value(b, c));
        }
    }
    MU_ASSERT(!t.cut);
    query_reply(b, own, question, "inform", content);
}
