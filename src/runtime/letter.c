/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/letter.h"

#include "runtime/outbox.h"

struct mu_mail letter_of(const muster_Mail *m)
{
    return (struct mu_mail){.src = m->src,
                            .dst = m->dst,
                            .seq = m->seq,
                            .directive = m->layer == WIRE_DIRECTIVE,
                            .layer = m->layer,
                            .performative = m->performative,
                            .language = m->language,
                            .ontology = m->ontology,
                            .reply_with = m->reply_with,
                            .in_reply_to = m->in_reply_to,
                            .conversation = m->conversation,
                            .content = m->content,
                            .reply_by_ns = m->reply_by_ns,
                            .priority = (enum mu_priority)m->priority,
                            .level = (enum mu_level)m->level,
                            .timed = m->due_ns >= 0,
                            .due_ns = m->due_ns >= 0 ? (uint64_t)m->due_ns : 0,
                            .ttl_ns = m->ttl_ns};
}
