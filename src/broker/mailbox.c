/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mailbox.h"

#include "muster/memory.h"

void mailbox_init(struct mailbox *m, uint32_t agents)
{
    *m = (struct mailbox){.posts_free = MU_NONE, .watch_head = MU_NONE, .watch_tail = MU_NONE};
    m->posts = mu_startup_array(MU_POSTS_MAX, sizeof *m->posts);
    m->boxes = mu_startup_array(agents, sizeof *m->boxes);
}

struct box *mailbox_box(struct mailbox *m, uint32_t agent)
{
    struct box *box = &m->boxes[agent];
    if (!box->begun) {
        *box = (struct box){.begun = true, .acked = m->base, .out = MU_NONE};
        for (int i = 0; i <= POST_FLIGHT; i++) {
            box->lists[i] = (struct post_queue){.head = MU_NONE, .tail = MU_NONE};
        }
    }
    return box;
}

uint32_t mailbox_count(const struct box *box)
{
    uint32_t count = 0;
    for (int i = 0; i <= POST_FLIGHT; i++) {
        count += box->lists[i].count;
    }
    return count;
}

/* --- lists of posts --------------------------------------------------------------------------- */

static void list_append(struct mailbox *m, struct box *box, uint32_t post, enum post_list list)
{
    struct post_queue *q = &box->lists[list];
    struct post *p = &m->posts[post];
    p->list = (uint8_t)list;
    q->count++;
    if (list == POST_HELD) {
        return;
    }
    p->next = MU_NONE;
    p->prev = q->tail;
    if (q->tail == MU_NONE) {
        q->head = post;
    } else {
        m->posts[q->tail].next = post;
    }
    q->tail = post;
}

static void list_prepend(struct mailbox *m, struct box *box, uint32_t post, enum post_list list)
{
    struct post_queue *q = &box->lists[list];
    struct post *p = &m->posts[post];
    p->list = (uint8_t)list;
    q->count++;
    p->prev = MU_NONE;
    p->next = q->head;
    if (q->head == MU_NONE) {
        q->tail = post;
    } else {
        m->posts[q->head].prev = post;
    }
    q->head = post;
}

static void list_remove(struct mailbox *m, struct box *box, uint32_t post)
{
    struct post *p = &m->posts[post];
    struct post_queue *q = &box->lists[p->list];
    q->count--;
    if (p->list == POST_HELD) {
        return;
    }
    if (p->prev == MU_NONE) {
        q->head = p->next;
    } else {
        m->posts[p->prev].next = p->next;
    }
    if (p->next == MU_NONE) {
        q->tail = p->prev;
    } else {
        m->posts[p->next].prev = p->prev;
    }
}

/* --- posts ------------------------------------------------------------------------------------ */

static uint32_t post_take(struct mailbox *m)
{
    uint32_t post = m->posts_free;
    if (post != MU_NONE) {
        m->posts_free = m->posts[post].next;
    } else if (m->posts_used < MU_POSTS_MAX) {
        post = m->posts_used++;
    } else {
        return MU_NONE;
    }
    m->posts_live++;
    return post;
}

static void post_give(struct mailbox *m, uint32_t post)
{
    struct post *p = &m->posts[post];
    if (p->sibling_prev == MU_NONE) {
        p->mail->posts = p->sibling_next;
    } else {
        m->posts[p->sibling_prev].sibling_next = p->sibling_next;
    }
    if (p->sibling_next != MU_NONE) {
        m->posts[p->sibling_next].sibling_prev = p->sibling_prev;
    }
    p->mail = NULL;
    p->next = m->posts_free;
    m->posts_free = post;
    m->posts_live--;
}

static enum post_list mail_queue(const struct mail *mail)
{
    return mail->letter.layer == 0 ? POST_URGENT : POST_ORDINARY;
}

mu_result mailbox_put(struct mailbox *m, uint32_t agent, struct mail *mail, bool held)
{
    struct box *box = mailbox_box(m, agent);
    uint32_t post = mailbox_count(box) < MU_BOX_MAX ? post_take(m) : MU_NONE;
    if (post == MU_NONE) {
        return MU_FULL;
    }
    struct post *p = &m->posts[post];
    *p = (struct post){.mail = mail,
                       .next = MU_NONE,
                       .prev = MU_NONE,
                       .sibling_next = mail->posts,
                       .sibling_prev = MU_NONE,
                       .agent = agent};
    if (mail->posts != MU_NONE) {
        m->posts[mail->posts].sibling_prev = post;
    }
    mail->posts = post;
    list_append(m, box, post, held ? POST_HELD : mail_queue(mail));
    return MU_OK;
}

void mailbox_admit(struct mailbox *m, uint32_t post)
{
    struct post *p = &m->posts[post];
    MU_ASSERT(p->list == POST_HELD);
    struct box *box = mailbox_box(m, p->agent);
    list_remove(m, box, post);
    list_append(m, box, post, mail_queue(p->mail));
}

void mailbox_withdraw(struct mailbox *m, uint32_t post)
{
    MU_ASSERT(m->posts[post].list != POST_FLIGHT);
    list_remove(m, mailbox_box(m, m->posts[post].agent), post);
    post_give(m, post);
}

/* --- handing out ------------------------------------------------------------------------------ */

static void queue_hand_out(struct mailbox *m, struct box *box, enum post_list list, uint32_t window)
{
    while (box->lists[list].count > 0 && box->lists[POST_FLIGHT].count < window) {
        uint32_t post = box->lists[list].head;
        list_remove(m, box, post);
        list_append(m, box, post, POST_FLIGHT);
        if (box->out == MU_NONE) {
            box->out = post;
        }
    }
}

void mailbox_hand_out(struct mailbox *m, uint32_t agent, enum mailbox_gate gate)
{
    struct box *box = mailbox_box(m, agent);
    if (gate != GATE_SHUT) {
        queue_hand_out(m, box, POST_URGENT, MU_WINDOW_MAX + MAILBOX_RESERVE);
    }
    if (gate == GATE_OPEN) {
        queue_hand_out(m, box, POST_ORDINARY, MU_WINDOW_MAX);
    }
}

void mailbox_take_back(struct mailbox *m, uint32_t agent)
{
    struct box *box = mailbox_box(m, agent);
    uint32_t post = box->lists[POST_FLIGHT].tail;
    while (post != MU_NONE && !m->posts[post].sent) {
        uint32_t before = m->posts[post].prev;
        if (box->out == post) {
            box->out = MU_NONE;
        }
        list_remove(m, box, post);
        list_prepend(m, box, post, mail_queue(m->posts[post].mail));
        post = before;
    }
}

uint32_t mailbox_mark_written(struct mailbox *m, uint32_t agent, uint32_t count)
{
    struct box *box = mailbox_box(m, agent);
    uint32_t again = 0;
    for (; count > 0; count--) {
        struct post *p = &m->posts[box->out];
        again += p->sent;
        p->sent = true;
        box->out = p->next;
        box->written++;
    }
    return again;
}

void mailbox_repeat(struct mailbox *m, uint32_t agent)
{
    struct box *box = mailbox_box(m, agent);
    box->out = box->lists[POST_FLIGHT].head;
    box->written = 0;
}

bool mailbox_number_valid(const struct mailbox *m, uint32_t agent, uint64_t number)
{
    const struct box *box = &m->boxes[agent];
    return number <= box->acked || number - box->acked <= box->lists[POST_FLIGHT].count;
}

struct mail *mailbox_pop(struct mailbox *m, uint32_t agent)
{
    struct box *box = mailbox_box(m, agent);
    uint32_t post = box->lists[POST_FLIGHT].head;
    MU_ASSERT(post != MU_NONE);
    struct mail *mail = m->posts[post].mail;
    if (box->out == post) { /* acknowledged while it was to go out again */
        box->out = m->posts[post].next;
    } else {
        box->written--;
    }
    list_remove(m, box, post);
    post_give(m, post);
    box->acked++;
    return mail;
}

/* --- watching --------------------------------------------------------------------------------- */

void mailbox_unwatch(struct mailbox *m, uint32_t agent)
{
    struct box *box = mailbox_box(m, agent);
    if (!box->watched) {
        return;
    }
    box->watched = false;
    if (box->watch_prev == MU_NONE) {
        m->watch_head = box->watch_next;
    } else {
        m->boxes[box->watch_prev].watch_next = box->watch_next;
    }
    if (box->watch_next == MU_NONE) {
        m->watch_tail = box->watch_prev;
    } else {
        m->boxes[box->watch_next].watch_prev = box->watch_prev;
    }
}

void mailbox_watch(struct mailbox *m, uint32_t agent, uint64_t now_ns)
{
    struct box *box = mailbox_box(m, agent);
    mailbox_unwatch(m, agent);
    if (box->lists[POST_FLIGHT].count == 0) {
        return;
    }
    box->watched = true;
    box->progress_ns = now_ns;
    box->watch_next = MU_NONE;
    box->watch_prev = m->watch_tail;
    if (m->watch_tail == MU_NONE) {
        m->watch_head = agent;
    } else {
        m->boxes[m->watch_tail].watch_next = agent;
    }
    m->watch_tail = agent;
}
