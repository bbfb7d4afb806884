/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/query_state.h"

#include "broker/control/parts.h"
#include "broker/membership/presence.h"
#include "broker/services/query.h"
#include "core/text.h"

#include <inttypes.h>

void query_state_answer(struct broker *b, uint32_t own, const struct mail *question)
{
    struct mu_text t;
    if (presence_in_lockstep(b, question->sender)) {
        query_begin(b, &t, "in-lock-step");
        query_reply(b, own, question, "failure", b->text);
        return;
    }
    query_begin(b, &t, counters_part_name(own));
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
    query_reply(b, own, question, "inform", b->text);
}
