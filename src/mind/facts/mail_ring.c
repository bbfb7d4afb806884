/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Mail for (getmsg) without a mail fact, as text.  Most robots never ask for it, and a copy into a
 * ring costs next to nothing.
 */
#include "mind/facts/facts.h"
#include "muster/memory.h"

#include <string.h>

struct mail_ring *mail_ring_reserve(void)
{
    return mu_startup_alloc(sizeof(struct mail_ring));
}

void mail_ring_install(struct mind *m)
{
    inputs_of(m)->mail_ring->first = inputs_of(m)->mail_ring->count = 0;
}

static struct mail_ring_entry *ring_at(struct mail_ring *p, uint32_t index)
{
    return &p->mails[(p->first + index) % MAIL_RING_MAX];
}

/*
 * Finds room for so many bytes in one piece behind the last content.
 * @return false: there is none
 */
static bool ring_place(struct mail_ring *p, uint32_t bytes, uint32_t *at)
{
    *at = 0;
    if (p->count == 0 || p->count == MAIL_RING_MAX) {
        return p->count == 0;
    }
    uint32_t start = ring_at(p, 0)->at;
    const struct mail_ring_entry *last = ring_at(p, p->count - 1);
    uint32_t end = last->at + last->bytes;
    if (last->at < start) { /* the ring has wrapped: the room is between end and start */
        *at = end;
        return start - end >= bytes;
    }
    *at = MAIL_RING_BYTES - end >= bytes ? end : 0;
    return *at == end || start >= bytes;
}

mu_result mail_ring_put(struct mind *m, const struct mind_mail *mail, bool clips)
{
    struct mail_ring *p = inputs_of(m)->mail_ring;
    uint32_t len = (uint32_t)strnlen(mail->content, MU_CONTENT_MAX);
    uint32_t at;
    while (!ring_place(p, len + 1, &at)) {
        if (inputs_of(m)->rules_getmsg) {
            return MU_FULL;
        }
        mail_ring_drop(m);
    }
    struct mail_ring_entry *to = ring_at(p, p->count++);
    *to = (struct mail_ring_entry){.id = mail->id,
                                   .at = at,
                                   .bytes = len + 1,
                                   .clips = clips,
                                   .from = EnvAddSymbol(m->env, mail->src)};
    IncrementSymbolCount(to->from);
    memcpy(p->bytes + at, mail->content, len);
    p->bytes[at + len] = '\0';
    return MU_OK;
}

const struct mail_ring_entry *mail_ring_first(const struct mind *m, const char **content)
{
    struct mail_ring *p = inputs_of(m)->mail_ring;
    const struct mail_ring_entry *first = p->count > 0 ? ring_at(p, 0) : NULL;
    *content = first ? p->bytes + first->at : "";
    return first;
}

void mail_ring_drop(struct mind *m)
{
    struct mail_ring *p = inputs_of(m)->mail_ring;
    MU_ASSERT(p->count > 0);
    DecrementSymbolCount(m->env, p->mails[p->first].from);
    p->first = (p->first + 1) % MAIL_RING_MAX;
    p->count--;
}
