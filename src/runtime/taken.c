/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/taken.h"

#include "core/hash.h"
#include "muster/limits.h"

_Static_assert(TAKEN_MAX > MU_WINDOW_MAX + 8, "a window, and directives beyond it");

void taken_clear(struct taken *t)
{
    if (t->mails[0].seq != 0) {
        *t = (struct taken){.next = 0};
    }
}

void taken_add(struct taken *t, const char *src, uint64_t seq)
{
    t->mails[t->next].sender = mu_hash_string(src);
    t->mails[t->next].seq = seq;
    t->next = (t->next + 1) % TAKEN_MAX;
}

bool taken_has(const struct taken *t, const char *src, uint64_t seq)
{
    uint64_t sender = mu_hash_string(src);
    for (uint32_t i = 0; i < TAKEN_MAX; i++) {
        if (t->mails[i].seq == seq && t->mails[i].sender == sender) {
            return seq != 0;
        }
    }
    return false;
}
