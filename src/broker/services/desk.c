/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/desk.h"

#include "broker/control/parts.h"
#include "broker/services/directive.h"
#include "broker/services/query.h"
#include "broker/services/query_state.h"

#include <string.h>

void desk_take(struct broker *b, uint32_t own, struct mail *m)
{
    bool asks_state = m->letter.layer == 2 && strcmp(m->letter.performative, "state") == 0;
    if (m->letter.layer == 0) {
        directive_take(b, own, m);
    } else if (asks_state) {
        query_state_answer(b, own, m);
    } else if (own == REGISTRY_BROKER) {
        query_answer(b, m);
    } else {
        query_refuse(b, own, m);
    }
}
