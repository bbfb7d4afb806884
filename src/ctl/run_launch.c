/* SPDX-License-Identifier: Apache-2.0 */
/* Agents that an experiment launches on its hosts, each at its time. */
#include "core/pieces.h"
#include "ctl/launch_text.h"
#include "ctl/run.h"

#include <math.h>
#include <stdio.h>

static mu_result pieces_send(struct run *r, const struct mu_mail *piece, const struct mu_text *text)
{
    static char content[MU_CONTENT_MAX + 1];
    struct mu_mail mail = *piece;
    mail.content = content;
    mu_result sent = MU_OK;
    size_t at = 0;
    for (unsigned number = 0; at < text->len && sent == MU_OK; number++) {
        at += mu_pieces_numbered(content, number, text->at, text->len, at);
        sent = run_directive_send(r, mail);
    }
    return sent;
}

mu_result run_launch_tell(struct run *r, unsigned index)
{
    const struct experiment_command *c = &r->experiment->observer[index];
    char label[32], id[MU_NAME_MAX + 32];
    snprintf(label, sizeof label, "%u", index);
    struct mu_text *text = launch_text_begin(c->launch, true, (int64_t)r->experiment->seed);
    mu_result sent = launch_text_rules(text, c->rules);
    for (unsigned t = 0; t < c->targets_count && sent == MU_OK; t++) {
        snprintf(id, sizeof id, "launch-%u-%s", index, c->targets[t]);
        struct mu_mail piece = {.dst = c->targets[t],
                                .performative = "launch",
                                .conversation = id,
                                .reply_with = label,
                                .timed = true,
                                .due_ns = (uint64_t)llround(c->at * 1e9)};
        sent = pieces_send(r, &piece, text);
    }
    return sent;
}
