/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"
#include "muster/result.h"

/* What is within a sender's share of the store, however full that is. */
static const struct share_use store_floor = {.mails = 64, .bytes = 64 * 1024, .posts = 1024};

/* One in so many places of the store is for directives alone. */
enum { RESERVE_PART = 64 };

static enum share_answer ask_one(uint32_t own, uint32_t all, uint32_t want, uint32_t most,
                                 uint32_t floor)
{
    uint64_t mine = (uint64_t)own + want, together = (uint64_t)all + want;
    uint64_t left = together < most ? most - together : 0;
    if (own > 0 && mine > floor && mine > left) {
        return SHARE_OVER;
    }
    return together > most ? SHARE_FULL : SHARE_FITS;
}

enum share_answer share_ask(const struct share_use *own, const struct share_use *all,
                            const struct share_use *want, const struct share_use *most,
                            const struct share_use *floor)
{
    const enum share_answer answers[] = {
        ask_one(own->mails, all->mails, want->mails, most->mails, floor->mails),
        ask_one(own->bytes, all->bytes, want->bytes, most->bytes, floor->bytes),
        ask_one(own->posts, all->posts, want->posts, most->posts, floor->posts)};
    enum share_answer worst = SHARE_FITS;
    for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++) {
        worst = answers[i] > worst ? answers[i] : worst;
    }
    return worst;
}

void share_add(struct share_use *use, const struct share_use *more)
{
    use->mails += more->mails;
    use->bytes += more->bytes;
    use->posts += more->posts;
}

void share_subtract(struct share_use *use, const struct share_use *less)
{
    MU_ASSERT(use->mails >= less->mails && use->bytes >= less->bytes && use->posts >= less->posts);
    use->mails -= less->mails;
    use->bytes -= less->bytes;
    use->posts -= less->posts;
}

/* --- the store's accounts --------------------------------------------------------------------- */

void share_init(struct share_accounts *a, uint32_t agents)
{
    *a = (struct share_accounts){0};
    for (int side = 0; side < SHARE_SIDES; side++) {
        a->senders[side] = mu_startup_array(agents, sizeof(struct share_use));
    }
}

static void use_shrink(struct share_use *use, uint32_t part)
{
    use->mails -= use->mails / part;
    use->bytes -= use->bytes / part;
    use->posts -= use->posts / part;
}

static struct share_use side_most(enum share_side side, bool halved)
{
    struct share_use most = {
        .mails = MU_MAILS_MAX, .bytes = MU_MAIL_BYTES_MAX, .posts = MU_POSTS_MAX};
    if (halved || side == SHARE_LOCKSTEP) {
        use_shrink(&most, 2);
    }
    return most;
}

enum share_answer share_book(struct share_accounts *a, enum share_side side, uint32_t sender,
                             const struct share_use *want, bool halved, bool urgent)
{
    static const struct share_use nothing;
    struct share_use *own = &a->senders[side][sender];
    struct share_use most = side_most(side, halved);
    if (!urgent) {
        use_shrink(&most, RESERVE_PART);
    }
    enum share_answer answer =
        share_ask(urgent ? &nothing : own, &a->all[side], want, &most, &store_floor);
    if (answer == SHARE_FITS) {
        share_add(own, want);
        share_add(&a->all[side], want);
    }
    return answer;
}

bool share_restore(struct share_accounts *a, enum share_side *side, uint32_t sender,
                   const struct share_use *want)
{
    static const struct share_use nothing;
    for (*side = SHARE_OUTSIDE; *side < SHARE_SIDES; (*side)++) {
        struct share_use most = side_most(*side, false);
        if (share_ask(&nothing, &a->all[*side], want, &most, &store_floor) == SHARE_FITS) {
            share_add(&a->senders[*side][sender], want);
            share_add(&a->all[*side], want);
            return true;
        }
    }
    return false;
}

void share_unbook(struct share_accounts *a, enum share_side side, uint32_t sender,
                  const struct share_use *less)
{
    share_subtract(&a->senders[side][sender], less);
    share_subtract(&a->all[side], less);
}
