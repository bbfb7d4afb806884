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

/* --- a box ---------------------------------------------------------------------------------------
 */

/* What is within a sender's share of a large box, however full it is.  A small one holds as many
 * mails of a lone sender as it says; of its bytes, a part is within anybody's share. */
static const struct quota_use floor_most = {.mails = 64, .bytes = 64 * 1024};
enum { FLOOR_BYTES_PART = 8 };

/* A box and one sender, as the mail finds them. */
struct asked {
    struct quota_use own, all, want, most, floor;
    const struct post_queue *own_waiting; /* MAILBOX_QUOTA_QUEUES of them, or NULL */
    const struct post_queue *all_waiting; /* likewise */
    uint32_t queues; /* the mail may drop others from so many, beginning with the lowest */
    bool lowest;     /* and from that first, however old the others are */
};

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static struct asked ask_begin(struct mailbox *m, uint32_t agent, const struct mail *mail)
{
    const struct box *box = mailbox_box(m, agent);
    struct box_limits limits = mailbox_limits(m, box);
    struct asked ask = {
        .all = box->use,
        .want = {.mails = 1, .bytes = mail->bytes},
        .most = {.mails = limits.mails, .bytes = limits.bytes},
        .floor = {.mails = least(floor_most.mails, limits.mails),
                  .bytes = least(floor_most.bytes, limits.bytes / FLOOR_BYTES_PART)},
        .all_waiting = &box->lists[POST_LOW],
        .lowest = limits.policy == muster_BOX_DROP_LOWEST,
    };
    uint32_t pair = mailbox_quota_find(&m->quotas, agent, mail->payer);
    if (pair != MU_NONE) {
        ask.own = m->quotas.at[pair].use;
        ask.own_waiting = m->quotas.at[pair].waiting;
    }
    switch (limits.policy) {
    case muster_BOX_REFUSE_NEW: break;
    case muster_BOX_DROP_OLDEST: ask.queues = MAILBOX_QUOTA_QUEUES; break;
    case muster_BOX_DROP_LOWEST: ask.queues = (uint32_t)(mailbox_queue(mail) - POST_LOW) + 1; break;
    }
    return ask;
}

/* What these queues hold. */
static struct quota_use waiting_sum(const struct post_queue *waiting, uint32_t queues)
{
    struct quota_use sum = {0};
    for (uint32_t i = 0; waiting && i < queues; i++) {
        sum.mails += waiting[i].posts.count;
        sum.bytes += waiting[i].bytes;
    }
    return sum;
}

static enum quota_answer ask_answer(const struct asked *ask)
{
    return quota_ask(&ask->own, &ask->all, &ask->want, &ask->most, &ask->floor);
}

/* Whether the mail would fit if all of these went: nothing is dropped in vain. */
static bool drop_helps(const struct asked *ask, const struct post_queue *waiting)
{
    struct quota_use gone = waiting_sum(waiting, ask->queues);
    struct quota_use mine = waiting_sum(ask->own_waiting, ask->queues);
    struct asked then = *ask;
    quota_subtract(&then.all, &gone);
    quota_subtract(&then.own, &mine); /* what goes is this alone, or this among others' */
    return gone.mails > 0 && ask_answer(&then) == QUOTA_FITS;
}

/* @return the first of the lowest queue, or, of all queues, the one that was sent first */
static uint32_t victim_of(const struct mailbox *m, const struct asked *ask,
                          const struct post_queue *waiting)
{
    uint32_t victim = MU_NONE;
    uint64_t first = UINT64_MAX;
    for (uint32_t i = 0; i < ask->queues && (victim == MU_NONE || !ask->lowest); i++) {
        uint32_t head = mu_list_first(&waiting[i].posts);
        uint64_t order = head != MU_NONE ? m->posts[head].mail->order : UINT64_MAX;
        if (order < first) {
            first = order;
            victim = head;
        }
    }
    return victim;
}

enum mailbox_room quota_box_ask(struct mailbox *m, uint32_t agent, const struct mail *mail,
                                uint32_t *victim)
{
    struct asked ask = ask_begin(m, agent, mail);
    if (mail->letter.layer == 0) { /* directives have a reserve, and no share */
        bool fits = ask.all.mails < ask.most.mails + MAILBOX_RESERVE;
        return fits ? MAILBOX_ROOM_FITS : MAILBOX_ROOM_FULL;
    }
    enum quota_answer answer = ask_answer(&ask);
    if (answer == QUOTA_FITS) {
        return MAILBOX_ROOM_FITS;
    }
    const struct post_queue *from = answer == QUOTA_OVER ? ask.own_waiting : ask.all_waiting;
    if (drop_helps(&ask, from)) {
        *victim = victim_of(m, &ask, from);
        return MAILBOX_ROOM_DROP;
    }
    return answer == QUOTA_OVER ? MAILBOX_ROOM_OVER_QUOTA : MAILBOX_ROOM_FULL;
}
