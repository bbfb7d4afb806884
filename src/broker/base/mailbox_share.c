/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"
#include "muster/result.h"

void mailbox_share_init(struct mailbox_shares *p)
{
    uint32_t slots = 1;
    while (slots < MU_POSTS_MAX) {
        slots *= 2;
    }
    *p = (struct mailbox_shares){.mask = slots - 1};
    p->at = mu_startup_array(QUOTA_POSTS_MAX, sizeof *p->at);
    mu_pool_init(&p->pool, QUOTA_POSTS_MAX);
    p->heads = mu_startup_array(slots, sizeof *p->heads);
}

/* Fibonacci hashing scatters the boxes; neighbours among the senders stay neighbours. */
static uint32_t *head_of(const struct mailbox_shares *p, uint32_t box, uint32_t sender)
{
    return &p->heads[(box * 2654435769u ^ sender) & p->mask];
}

uint32_t mailbox_share_find(const struct mailbox_shares *p, uint32_t box, uint32_t sender)
{
    uint32_t next = *head_of(p, box, sender);
    while (next != 0) {
        const struct mailbox_share *pair = &p->at[next - 1];
        if (pair->box == box && pair->sender == sender) {
            return next - 1;
        }
        next = pair->next;
    }
    return MU_NONE;
}

uint32_t mailbox_share_get(struct mailbox_shares *p, uint32_t box, uint32_t sender)
{
    uint32_t pair = mailbox_share_find(p, box, sender);
    if (pair != MU_NONE) {
        return pair;
    }
    pair = mu_pool_take(&p->pool);
    MU_ASSERT(pair != MU_NONE); /* each has a post */
    uint32_t *head = head_of(p, box, sender);
    p->at[pair] = (struct mailbox_share){.box = box, .sender = sender, .next = *head};
    *head = pair + 1;
    return pair;
}

void mailbox_share_drop(struct mailbox_shares *p, uint32_t pair)
{
    struct mailbox_share *gone = &p->at[pair];
    MU_ASSERT(gone->use.mails == 0 && gone->use.bytes == 0);
    uint32_t *link = head_of(p, gone->box, gone->sender);
    while (*link != pair + 1) {
        link = &p->at[*link - 1].next;
    }
    *link = gone->next;
    mu_pool_give(&p->pool, pair);
}
