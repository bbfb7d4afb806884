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

void outbox_init(struct outbox *box, uint32_t mails, struct outbox_slot *slots, char *text)
{
    *box = (struct outbox){.slots = slots,
                           .mails = mails,
                           .text = text,
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

mu_result outbox_put(struct outbox *box, const char *src, const struct mu_mail *mail)
{
    const char *from[OUTBOX_STRINGS] = {src,
                                        or_empty(mail->dst),
                                        or_empty(mail->performative),
                                        or_empty(mail->language),
                                        or_empty(mail->ontology),
                                        or_empty(mail->reply_with),
                                        or_empty(mail->in_reply_to),
                                        or_empty(mail->conversation),
                                        or_empty(mail->content)};
    static const size_t most[OUTBOX_STRINGS] = {MU_NAME_MAX,  MU_DST_MAX,   MU_FIELD_MAX,
                                                MU_FIELD_MAX, MU_FIELD_MAX, MU_FIELD_MAX,
                                                MU_FIELD_MAX, MU_FIELD_MAX, MU_CONTENT_MAX};
    size_t bytes = 0;
    size_t lens[OUTBOX_STRINGS];
    for (size_t i = 0; i < OUTBOX_STRINGS; i++) {
        lens[i] = (from[i][0] ? strnlen(from[i], most[i] + 1) : 0) + 1;
        bytes += lens[i];
        if (lens[i] > most[i] + 1) {
            return MU_MALFORMED;
        }
    }
    if (from[1][0] == '\0') {
        return MU_MALFORMED;
    }
    char *at = box->next_seq - box->first_seq == box->mails ? NULL : text_take(box, bytes);
    if (!at) {
        return MU_FULL;
    }
    char *copy[OUTBOX_STRINGS];
    for (size_t i = 0; i < OUTBOX_STRINGS; i++) {
        copy[i] = memcpy(at, from[i], lens[i]);
        at += lens[i];
    }
    *slot_of(box, box->next_seq) = (struct outbox_slot){
        .mail = {.src = copy[0],
                 .seq = box->next_seq,
                 .dst = copy[1],
                 .layer = wire_layer(mail),
                 .performative = copy[2],
                 .language = copy[3],
                 .ontology = copy[4],
                 .reply_with = copy[5],
                 .in_reply_to = copy[6],
                 .conversation = copy[7],
                 .reply_by_ns = mail->reply_by_ns,
                 .priority = mail->priority,
                 .level = (muster_Level)mail->level,
                 .due_ns = mail->timed ? (int64_t)mail->due_ns : -1,
                 .ttl_ns = mail->ttl_ns,
                 .content = copy[8]},
        .text_end = (size_t)(at - box->text),
    };
    box->next_seq++;
    return MU_OK;
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

void outbox_confirm(struct outbox *box, uint64_t first_seq, uint64_t last_seq)
{
    uint64_t first = first_seq > box->first_seq ? first_seq : box->first_seq;
    uint64_t end = last_seq < box->next_seq ? last_seq + 1 : box->next_seq;
    for (uint64_t seq = first; seq < end; seq++) {
        slot_of(box, seq)->confirmed = true;
    }
    while (box->first_seq < box->next_seq && slot_of(box, box->first_seq)->confirmed) {
        box->text_tail = slot_of(box, box->first_seq)->text_end;
        box->first_seq++;
    }
    if (box->unsent_seq < box->first_seq) {
        box->unsent_seq = box->first_seq;
    }
}

void outbox_again(struct outbox *box)
{
    for (uint64_t seq = box->first_seq; seq < box->next_seq; seq++) {
        slot_of(box, seq)->mail.again = slot_of(box, seq)->sent;
    }
    box->unsent_seq = box->first_seq;
}
