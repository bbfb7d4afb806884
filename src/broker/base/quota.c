/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

static enum quota_answer ask_one(uint32_t own, uint32_t all, uint32_t want, uint32_t most,
                                 uint32_t floor)
{
    uint64_t mine = (uint64_t)own + want, together = (uint64_t)all + want;
    uint64_t left = together < most ? most - together : 0;
    if (own > 0 && mine > floor && mine > left) {
        return QUOTA_OVER;
    }
    return together > most ? QUOTA_FULL : QUOTA_FITS;
}

enum quota_answer quota_ask(const struct quota_use *own, const struct quota_use *all,
                            const struct quota_use *want, const struct quota_use *most,
                            const struct quota_use *floor)
{
    const enum quota_answer answers[] = {
        ask_one(own->mails, all->mails, want->mails, most->mails, floor->mails),
        ask_one(own->bytes, all->bytes, want->bytes, most->bytes, floor->bytes),
        ask_one(own->posts, all->posts, want->posts, most->posts, floor->posts)};
    enum quota_answer worst = QUOTA_FITS;
    for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++) {
        worst = answers[i] > worst ? answers[i] : worst;
    }
    return worst;
}
