/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/outbox.h"

#include <string.h>

/* The strings of a mail, in the one order in which they lie in the text ring. */
enum { OUTBOX_STRINGS = 9 };

static struct outbox_slot *slot_of(const struct outbox *box, uint64_t seq)
{
    return &box->slots[(seq - box->renumbered) % box->mails];
}

size_t outbox_text_bytes(uint32_t mails)
{
    size_t bytes = (size_t)mails * OUTBOX_TEXT_EACH;
    return bytes > OUTBOX_TEXT_MIN ? bytes : OUTBOX_TEXT_MIN;
}

void outbox_init(struct outbox *box, uint32_t mails, struct outbox_slot *slots, char *text,
                 uint64_t since_wall_ns)
{
    *box = (struct outbox){.slots = slots,
                           .mails = mails,
                           .text = text,
                           .since_wall_ns = since_wall_ns,
                           .first_seq = 1,
                           .next_seq = 1,
                           .unsent_seq = 1};
}

bool outbox_has_unsent(const struct outbox *box)
{
    return box->unsent_seq < box->next_seq;
}

bool outbox_has_unanswered(const struct outbox *box)
{
    return box->unsent_seq > box->first_seq;
}

void outbox_continue(struct outbox *box, uint64_t last_seq)
{
    /* Numbers that have gone out stand.  A sender that has just started has none of these, however
     * many mails wait already: all of them are numbered anew. */
    uint64_t known = box->begun ? box->next_seq - 1 : box->first_seq - 1;
    if (last_seq <= known || box->unsent_seq != box->first_seq) {
        return;
    }
    uint64_t shift = last_seq + 1 - box->first_seq;
    for (uint64_t seq = box->first_seq; seq < box->next_seq; seq++) {
        slot_of(box, seq)->mail.seq += shift;
    }
    box->renumbered += shift;
    box->first_seq += shift;
    box->next_seq += shift;
    box->unsent_seq += shift;
}

void outbox_rewind(struct outbox *box, uint64_t count)
{
    if (box->begun || box->first_seq != box->next_seq || count > box->renumbered) {
        return;
    }
    box->renumbered -= count;
    box->first_seq = box->next_seq = box->unsent_seq = box->next_seq - count;
}

/* Finds room for bytes of text in one piece.  @return where, or NULL */
static char *text_take(struct outbox *box, size_t bytes)
{
    if (box->first_seq == box->next_seq) {
        box->text_head = box->text_tail = 0;
    }
    bool wrapped = box->text_head < box->text_tail;
    size_t limit = wrapped ? box->text_tail : outbox_text_bytes(box->mails);
    /* One byte stays free, or a full ring would look empty. */
    if (bytes < limit - box->text_head) {
        char *at = box->text + box->text_head;
        box->text_head += bytes;
        return at;
    }
    if (!wrapped && bytes < box->text_tail) {
        box->text_head = bytes;
        return box->text;
    }
    return NULL;
}

static const char *or_empty(const char *s)
{
    return s ? s : "";
}

static uint32_t wire_layer(const struct mu_mail *mail)
{
    if (mail->directive) {
        return WIRE_DIRECTIVE;
    }
    return mail->layer ? mail->layer : MU_LAYER_SPEECH;
}

/* A time that the wire has no number for never comes. */
static int64_t wire_due_ns(uint64_t due_ns)
{
    return due_ns < INT64_MAX ? (int64_t)due_ns : INT64_MAX;
}

/* @return whether the broker takes the mail's numbers; else it would refuse the whole Up */
static bool numbers_fit(const struct mu_mail *mail)
{
    return mail->priority >= MU_PRIORITY_LOW && mail->priority <= MU_PRIORITY_HIGH &&
           (unsigned)mail->level <= MU_LEVEL_SYNCED;
}

/* The strings of a mail that is to be sent, and how many bytes each takes with its zero. */
struct strings {
    const char *from[OUTBOX_STRINGS];
    size_t lens[OUTBOX_STRINGS], bytes;
};

/* @return whether each fits the wire, and there is a receiver */
static bool strings_measure(struct strings *s)
{
    static const size_t most[OUTBOX_STRINGS] = {MU_NAME_MAX,  MU_DST_MAX,   MU_FIELD_MAX,
                                                MU_FIELD_MAX, MU_FIELD_MAX, MU_FIELD_MAX,
                                                MU_FIELD_MAX, MU_FIELD_MAX, MU_CONTENT_MAX};
    s->bytes = 0;
    for (size_t i = 0; i < OUTBOX_STRINGS; i++) {
        s->lens[i] = (s->from[i][0] ? strnlen(s->from[i], most[i] + 1) : 0) + 1;
        s->bytes += s->lens[i];
        if (s->lens[i] > most[i] + 1) {
            return false;
        }
    }
    return s->from[1][0] != '\0';
}

/* Copies them one behind the other.  @return the end */
static char *strings_copy(const struct strings *s, char *at, char *copy[OUTBOX_STRINGS])
{
    for (size_t i = 0; i < OUTBOX_STRINGS; i++) {
        copy[i] = memcpy(at, s->from[i], s->lens[i]);
        at += s->lens[i];
    }
    return at;
}

static void wire_mail(muster_Mail *out, const struct outbox *box, const struct mu_mail *mail,
                      char *strings[OUTBOX_STRINGS])
{
    *out = (muster_Mail){.src = strings[0],
                         .since_wall_ns = box->since_wall_ns,
                         .seq = box->next_seq,
                         .dst = strings[1],
                         .layer = wire_layer(mail),
                         .performative = strings[2],
                         .language = strings[3],
                         .ontology = strings[4],
                         .reply_with = strings[5],
                         .in_reply_to = strings[6],
                         .conversation = strings[7],
                         .reply_by_ns = mail->reply_by_ns,
                         .priority = mail->priority,
                         .level = (muster_Level)mail->level,
                         .again = false,
                         .hops = 0,
                         .due_ns = mail->timed ? wire_due_ns(mail->due_ns) : -1,
                         .ttl_ns = mail->ttl_ns,
                         .content = strings[8]};
}

mu_result outbox_put(struct outbox *box, const char *src, const struct mu_mail *mail)
{
    struct strings s = {.from = {src, or_empty(mail->dst), or_empty(mail->performative),
                                 or_empty(mail->language), or_empty(mail->ontology),
                                 or_empty(mail->reply_with), or_empty(mail->in_reply_to),
                                 or_empty(mail->conversation), or_empty(mail->content)}};
    char *copy[OUTBOX_STRINGS];
    if (!numbers_fit(mail) || !strings_measure(&s)) {
        return MU_MALFORMED;
    }
    char *at = box->next_seq - box->first_seq == box->mails ? NULL : text_take(box, s.bytes);
    if (!at) {
        return MU_FULL;
    }
    char *end = strings_copy(&s, at, copy);
    struct outbox_slot *slot = slot_of(box, box->next_seq); /* filled in place: no copy is made */
    wire_mail(&slot->mail, box, mail, copy);
    slot->text_end = (size_t)(end - box->text);
    slot->confirmed = slot->ended = slot->sent = false;
    slot->had = 0;
    box->next_seq++;
    return MU_OK;
}

void outbox_recall(struct outbox *box, const char *src, uint64_t seq, const struct mu_mail *mail)
{
    static const struct mu_mail answered = {.dst = "-"};
    uint64_t first = box->next_seq;
    mu_result put = MU_OK;
    while (put == MU_OK && box->next_seq < seq) {
        put = outbox_put(box, src, &answered);
    }
    if (put == MU_OK && mail) {
        put = outbox_put(box, src, mail);
    }
    outbox_sent(box, (uint32_t)(box->next_seq - box->unsent_seq));
    outbox_confirm(box, first, seq - 1);
}

uint32_t outbox_unsent(const struct outbox *box, muster_Mail *mails, uint32_t max)
{
    uint32_t count = 0;
    for (uint64_t seq = box->unsent_seq; seq < box->next_seq && count < max; seq++) {
        mails[count++] = slot_of(box, seq)->mail;
    }
    return count;
}

void outbox_sent(struct outbox *box, uint32_t count)
{
    MU_ASSERT(count <= box->next_seq - box->unsent_seq);
    for (uint64_t seq = box->unsent_seq; seq < box->unsent_seq + count; seq++) {
        slot_of(box, seq)->sent = true;
    }
    box->unsent_seq += count;
    if (!box->begun && count > 0) {
        box->begun = true;
        box->own_seq = box->unsent_seq - count;
    }
}

uint64_t outbox_range(const struct outbox *box, uint64_t *first, uint64_t last_seq)
{
    *first = *first > box->first_seq ? *first : box->first_seq;
    return last_seq < box->next_seq ? last_seq + 1 : box->next_seq;
}

const muster_Mail *outbox_awaited(const struct outbox *box, uint64_t seq)
{
    const struct outbox_slot *slot = slot_of(box, seq);
    return slot->sent && !slot->confirmed ? &slot->mail : NULL;
}

static void confirmed_drop(struct outbox *box)
{
    while (box->first_seq < box->next_seq && slot_of(box, box->first_seq)->confirmed) {
        box->text_tail = slot_of(box, box->first_seq)->text_end;
        box->first_seq++;
    }
    if (box->unsent_seq < box->first_seq) {
        box->unsent_seq = box->first_seq;
    }
}

void outbox_confirm(struct outbox *box, uint64_t first_seq, uint64_t last_seq)
{
    uint64_t end = outbox_range(box, &first_seq, last_seq);
    for (uint64_t seq = first_seq; seq < end; seq++) {
        slot_of(box, seq)->confirmed = true;
    }
    confirmed_drop(box);
}

void outbox_end(struct outbox *box, uint64_t first_seq, uint64_t last_seq)
{
    uint64_t from_seq = first_seq;
    uint64_t end = outbox_range(box, &from_seq, last_seq);
    for (uint64_t seq = from_seq; seq < end; seq++) {
        slot_of(box, seq)->ended = slot_of(box, seq)->sent;
    }
    outbox_confirm(box, first_seq, last_seq);
}

void outbox_had(struct outbox *box, uint64_t first_seq, uint64_t last_seq)
{
    uint64_t end = outbox_range(box, &first_seq, last_seq);
    for (uint64_t seq = first_seq; seq < end; seq++) {
        struct outbox_slot *slot = slot_of(box, seq);
        slot->confirmed = slot->confirmed || ++slot->had >= OUTBOX_HAD;
    }
    confirmed_drop(box);
}

/* @return the rest of a mail that is over: its number, which the mails behind it need */
static muster_Mail letter_spent(const muster_Mail *m)
{
    static char none[1];
    return (muster_Mail){.src = m->src,
                         .since_wall_ns = m->since_wall_ns,
                         .seq = m->seq,
                         .dst = none,
                         .layer = m->layer,
                         .performative = none,
                         .language = none,
                         .ontology = none,
                         .reply_with = none,
                         .in_reply_to = none,
                         .conversation = none,
                         .priority = m->priority,
                         .level = m->level,
                         .again = true,
                         .due_ns = -1,
                         .content = none};
}

void outbox_to_other(struct outbox *box)
{
    for (uint64_t seq = box->first_seq; seq < box->next_seq; seq++) {
        struct outbox_slot *slot = slot_of(box, seq);
        slot->had = 0;
        slot->mail = slot->ended ? letter_spent(&slot->mail) : slot->mail;
    }
    outbox_again(box);
}

void outbox_again(struct outbox *box)
{
    for (uint64_t seq = box->first_seq; seq < box->next_seq; seq++) {
        slot_of(box, seq)->mail.again = slot_of(box, seq)->sent;
    }
    box->unsent_seq = box->first_seq;
}
