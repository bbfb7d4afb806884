/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"
#include "muster/result.h"

/* What is within a sender's share of the store, however full that is. */
static const struct quota_use store_floor = {.mails = 64, .bytes = 64 * 1024, .posts = 1024};

/* One in so many places of the store is for directives alone. */
enum { RESERVE_PART = 64 };

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

/* --- the store's accounts --------------------------------------------------------------------- */

void quota_init(struct quota_accounts *a, uint32_t agents)
{
    *a = (struct quota_accounts){0};
    for (int side = 0; side < QUOTA_SIDES; side++) {
        a->senders[side] = mu_startup_array(agents, sizeof(struct quota_use));
    }
}

static void use_shrink(struct quota_use *use, uint32_t part)
{
    use->mails -= use->mails / part;
    use->bytes -= use->bytes / part;
    use->posts -= use->posts / part;
}

static struct quota_use side_most(enum quota_side side, bool halved)
{
    struct quota_use most = {
        .mails = MU_MAILS_MAX, .bytes = MU_MAIL_BYTES_MAX, .posts = MU_POSTS_MAX};
    if (halved || side == QUOTA_INSIDE) {
        use_shrink(&most, 2);
    }
    return most;
}

enum quota_answer quota_book(struct quota_accounts *a, enum quota_side side, uint32_t sender,
                             const struct quota_use *want, bool halved, bool urgent)
{
    static const struct quota_use nothing;
    struct quota_use *own = &a->senders[side][sender];
    struct quota_use most = side_most(side, halved);
    if (!urgent) {
        use_shrink(&most, RESERVE_PART);
    }
    enum quota_answer answer =
        quota_ask(urgent ? &nothing : own, &a->all[side], want, &most, &store_floor);
    if (answer == QUOTA_FITS) {
        quota_add(own, want);
        quota_add(&a->all[side], want);
    }
    return answer;
}

bool quota_restore(struct quota_accounts *a, enum quota_side *side, uint32_t sender,
                   const struct quota_use *want)
{
    static const struct quota_use nothing;
    for (*side = QUOTA_OUTSIDE; *side < QUOTA_SIDES; (*side)++) {
        struct quota_use most = side_most(*side, false);
        if (quota_ask(&nothing, &a->all[*side], want, &most, &store_floor) == QUOTA_FITS) {
            quota_add(&a->senders[*side][sender], want);
            quota_add(&a->all[*side], want);
            return true;
        }
    }
    return false;
}
