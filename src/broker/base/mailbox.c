/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"

/* --- quotas of senders ------------------------------------------------------------------------ */

static uint32_t quota_get(struct mailbox_quotas *p, uint32_t box, uint32_t sender)
{
    uint32_t pair = mailbox_quota_find(p, box, sender);
    if (pair != MU_NONE) {
        return pair;
    }
    pair = mu_pool_take(&p->pool);
    MU_ASSERT(pair != MU_NONE); /* each has a post */
    uint32_t *head = mailbox_quota_head(p, box, sender);
    p->at[pair] = (struct mailbox_quota){.box = box, .sender = sender, .next = *head};
    *head = pair + 1;
    return pair;
}

static void quota_drop(struct mailbox_quotas *p, uint32_t pair)
{
    struct mailbox_quota *gone = &p->at[pair];
    MU_ASSERT(gone->use.mails == 0 && gone->use.bytes == 0);
    uint32_t *link = mailbox_quota_head(p, gone->box, gone->sender);
    while (*link != pair + 1) {
        link = &p->at[*link - 1].next;
    }
    *link = gone->next;
    mu_pool_give(&p->pool, pair);
}

/* --- boxes ------------------------------------------------------------------------------------ */

void mailbox_init(struct mailbox *m)
{
    mu_pool_init(&m->posts_pool, QUOTA_POSTS_MAX);
    m->posts = mu_startup_array(QUOTA_POSTS_MAX, sizeof *m->posts);
    mu_pool_init(&m->quotas.pool, QUOTA_POSTS_MAX);
    m->quotas.at = mu_startup_array(QUOTA_POSTS_MAX, sizeof *m->quotas.at);
}

void mailbox_end(struct mailbox *m, uint32_t agent)
{
    const struct box *box = &m->boxes[agent];
    if (box->begun) {
        MU_ASSERT(box->use.mails == 0 && !mu_list_has(MU_LINKS(m->boxes, watch), agent));
        m->base = box->acked > m->base ? box->acked : m->base;
        m->boxes[agent] = (struct box){.begun = false};
    }
}

/* --- lists of posts --------------------------------------------------------------------------- */

static struct mu_links links_of(const struct mailbox *m, enum post_links links)
{
    return MU_LINKS(m->posts, links[links]);
}

static void queue_put(struct mailbox *m, struct post_queue *q, uint32_t post, enum post_links links,
                      bool first)
{
    (void)(first ? mu_list_prepend : mu_list_append)(&q->posts, links_of(m, links), post);
    q->bytes += m->posts[post].mail->bytes;
}

static void queue_remove(struct mailbox *m, struct post_queue *q, uint32_t post,
                         enum post_links links)
{
    (void)mu_list_remove(&q->posts, links_of(m, links), post);
    q->bytes -= m->posts[post].mail->bytes;
}

/* @return the sender's part of the queue that the post stands in, or NULL: it is not asked for */
static struct post_queue *pair_queue(struct mailbox *m, uint32_t post)
{
    const struct post *p = &m->posts[post];
    bool may_be_dropped = p->list >= POST_LOW && p->list <= POST_HIGH;
    return may_be_dropped ? &m->quotas.at[p->pair].waiting[p->list - POST_LOW] : NULL;
}

static void list_put(struct mailbox *m, struct box *box, uint32_t post, enum post_list list,
                     bool first)
{
    m->posts[post].list = (uint8_t)list;
    queue_put(m, &box->lists[list], post, LINKS_BOX, first);
    struct post_queue *senders = pair_queue(m, post);
    if (senders) {
        queue_put(m, senders, post, LINKS_PAIR, first);
    }
}

static void list_remove(struct mailbox *m, struct box *box, uint32_t post)
{
    queue_remove(m, &box->lists[m->posts[post].list], post, LINKS_BOX);
    struct post_queue *senders = pair_queue(m, post);
    if (senders) {
        queue_remove(m, senders, post, LINKS_PAIR);
    }
}

/* --- posts ------------------------------------------------------------------------------------ */

static void post_give(struct mailbox *m, uint32_t post)
{
    struct post *p = &m->posts[post];
    struct quota_use less = {.mails = 1, .bytes = p->mail->bytes};
    p->mail->veiled -= p->veiled;
    quota_subtract(&m->boxes[p->agent].use, &less);
    quota_subtract(&m->quotas.at[p->pair].use, &less);
    if (m->quotas.at[p->pair].use.mails == 0) {
        quota_drop(&m->quotas, p->pair);
    }
    (void)mu_list_remove(&p->mail->posts, links_of(m, LINKS_MAIL), post);
    p->mail = NULL;
    mu_pool_give(&m->posts_pool, post);
}

enum post_list mailbox_queue(const struct mail *mail)
{
    return mail->letter.layer == 0 ? POST_URGENT
                                   : (enum post_list)(POST_NORMAL + mail->letter.priority);
}

mu_result mailbox_put(struct mailbox *m, uint32_t agent, struct mail *mail, bool held)
{
    struct box *box = mailbox_box(m, agent);
    uint32_t post = mu_pool_take(&m->posts_pool);
    if (post == MU_NONE) {
        return MU_FULL;
    }
    m->posts[post] = (struct post){
        .mail = mail, .agent = agent, .pair = quota_get(&m->quotas, agent, mail->payer)};
    (void)mu_list_prepend(&mail->posts, links_of(m, LINKS_MAIL), post);
    struct quota_use more = {.mails = 1, .bytes = mail->bytes};
    quota_add(&box->use, &more);
    quota_add(&m->quotas.at[m->posts[post].pair].use, &more);
    list_put(m, box, post, held ? POST_HELD : mailbox_queue(mail), false);
    return MU_OK;
}

void mailbox_veil(struct mailbox *m, struct mail *mail)
{
    m->posts[mu_list_first(&mail->posts)].veiled = true;
    mail->veiled++;
}

void mailbox_admit(struct mailbox *m, uint32_t post)
{
    struct post *p = &m->posts[post];
    MU_ASSERT(p->list == POST_HELD);
    struct box *box = mailbox_box(m, p->agent);
    list_remove(m, box, post);
    list_put(m, box, post, mailbox_queue(p->mail), false);
}

void mailbox_withdraw(struct mailbox *m, uint32_t post)
{
    MU_ASSERT(m->posts[post].list != POST_FLIGHT);
    list_remove(m, mailbox_box(m, m->posts[post].agent), post);
    post_give(m, post);
}

/* --- handing out ------------------------------------------------------------------------------ */

static void post_fly(struct mailbox *m, struct box *box, uint32_t post)
{
    list_remove(m, box, post);
    list_put(m, box, post, POST_FLIGHT, false);
    box->out = box->out == MU_NONE ? post : box->out;
}

static void queue_hand_out(struct mailbox *m, struct box *box, enum post_list list, uint32_t window,
                           uint32_t *written)
{
    while (box->lists[list].posts.count > 0 && box->lists[POST_FLIGHT].posts.count < window) {
        uint32_t post = mu_list_first(&box->lists[list].posts);
        bool is_written = mail_is_written(m->posts[post].mail);
        if (is_written && *written == 0) {
            return;
        }
        *written -= is_written;
        post_fly(m, box, post);
    }
}

void mailbox_hand_out(struct mailbox *m, uint32_t agent, enum mailbox_gate gate, uint32_t written)
{
    struct box *box = &m->boxes[agent];
    if (gate != GATE_SHUT) {
        queue_hand_out(m, box, POST_URGENT, MU_WINDOW_MAX + MAILBOX_RESERVE, &written);
    }
    for (int list = POST_HIGH; gate == GATE_OPEN && list >= POST_LOW; list--) {
        queue_hand_out(m, box, (enum post_list)list, MU_WINDOW_MAX, &written);
    }
}

bool mailbox_next_is(struct mailbox *m, uint32_t agent, const struct mail *mail)
{
    const struct box *box = mailbox_box(m, agent);
    int list = POST_URGENT;
    while (list > POST_LOW && box->lists[list].posts.count == 0) {
        list--;
    }
    uint32_t head = mu_list_first(&box->lists[list].posts);
    return box->lists[POST_FLIGHT].posts.count < MU_WINDOW_MAX && head != MU_NONE &&
           m->posts[head].mail == mail;
}

void mailbox_hand_next(struct mailbox *m, uint32_t agent, const struct mail *mail)
{
    struct box *box = mailbox_box(m, agent);
    post_fly(m, box, mu_list_first(&box->lists[mailbox_queue(mail)].posts));
}

void mailbox_take_back(struct mailbox *m, uint32_t agent)
{
    struct box *box = &m->boxes[agent];
    uint32_t post = mu_list_last(&box->lists[POST_FLIGHT].posts);
    while (post != MU_NONE && !m->posts[post].sent) {
        uint32_t before = mu_list_prev(links_of(m, LINKS_BOX), post);
        if (box->out == post) {
            box->out = MU_NONE;
        }
        list_remove(m, box, post);
        list_put(m, box, post, mailbox_queue(m->posts[post].mail), true);
        post = before;
    }
}

uint32_t mailbox_mark_written(struct mailbox *m, uint32_t agent, uint32_t count, uint64_t watch_ns)
{
    struct box *box = mailbox_box(m, agent);
    uint32_t again = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct post *p = &m->posts[box->out];
        again += p->sent;
        p->sent = true;
        box->out = mailbox_next(m, box->out);
        box->written++;
    }
    mailbox_take_back(m, agent);
    bool watched = mu_list_has(MU_LINKS(m->boxes, watch), agent);
    if (watch_ns != MAILBOX_UNWATCHED && count > 0 && (again > 0 || !watched)) {
        mailbox_watch(m, agent, watch_ns);
    }
    return again;
}

void mailbox_repeat(struct mailbox *m, uint32_t agent)
{
    struct box *box = &m->boxes[agent];
    if (box->begun) {
        box->out = mu_list_first(&box->lists[POST_FLIGHT].posts);
        box->written = 0;
    }
}

struct mail *mailbox_pop(struct mailbox *m, uint32_t agent)
{
    struct box *box = mailbox_box(m, agent);
    uint32_t post = mu_list_first(&box->lists[POST_FLIGHT].posts);
    MU_ASSERT(post != MU_NONE);
    struct mail *mail = m->posts[post].mail;
    if (box->out == post) { /* acknowledged while it was to go out again */
        box->out = mailbox_next(m, post);
    } else {
        box->written--;
    }
    list_remove(m, box, post);
    post_give(m, post);
    box->acked++;
    if (box->lists[POST_FLIGHT].posts.count == 0) {
        mailbox_unwatch(m, agent);
    }
    return mail;
}

/* --- watching --------------------------------------------------------------------------------- */

void mailbox_unwatch(struct mailbox *m, uint32_t agent)
{
    (void)mu_list_remove(&m->watched, MU_LINKS(m->boxes, watch), agent);
}

void mailbox_watch(struct mailbox *m, uint32_t agent, uint64_t now_ns)
{
    struct box *box = &m->boxes[agent];
    mailbox_unwatch(m, agent);
    if (box->lists[POST_FLIGHT].posts.count > 0) {
        box->progress_ns = now_ns;
        (void)mu_list_append(&m->watched, MU_LINKS(m->boxes, watch), agent);
    }
}
