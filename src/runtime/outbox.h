/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file outbox.h
 * Mail that an agent has sent and the broker has not answered for.
 *
 * A ring of mails in order of seq, with their text in a ring of bytes.  Pure; one thread.
 */
#ifndef MUSTER_RUNTIME_OUTBOX_H
#define MUSTER_RUNTIME_OUTBOX_H

#include "muster/agent.h"
#include "wire.h"

/* The layer on the wire of a directive, which is in no layer of the chain. */
enum { WIRE_DIRECTIVE = 0 };

/* Text of the mails in an outbox, in bytes: for each mail, and at least the largest one. */
enum { OUTBOX_TEXT_EACH = 512, OUTBOX_TEXT_MIN = MU_CONTENT_MAX + 4096 };

enum { OUTBOX_HAD = 4 };

struct outbox_slot {
    muster_Mail mail; /* its strings point into the text ring */
    size_t text_end;  /* where its text ends in the ring */
    bool confirmed;   /* the broker has answered, */
    bool ended;       /* and that was the last word */
    uint8_t had;      /* how often this life of the broker has said that it has it */
    bool sent;        /* it has gone out */
};

struct outbox {
    struct outbox_slot *slots;
    uint32_t mails;              /* how many slots */
    char *text;                  /* outbox_text_bytes of them */
    uint64_t since_wall_ns;      /* that each mail says of its sender */
    uint64_t first_seq;          /* of the oldest mail that is kept; == next_seq: none */
    uint64_t next_seq;           /* that the next mail will bear */
    uint64_t unsent_seq;         /* the first that has not gone out (again) */
    uint64_t renumbered;         /* how far seq is ahead of what the slots were filled by */
    bool begun;                  /* a mail has gone out */
    bool replays;                /* its mails are a recording's, from now on */
    uint64_t own_seq;            /* the first that went out of this process */
    size_t text_head, text_tail; /* used bytes, from tail to head, around the end */
};

/** @return the text of an outbox for so many mails, in bytes */
size_t outbox_text_bytes(uint32_t mails);

/** Begins in memory that stays the caller's; the first mail will bear number 1.  since_wall_ns:
 * when its sender began. */
void outbox_init(struct outbox *box, uint32_t mails, struct outbox_slot *slots, char *text,
                 uint64_t since_wall_ns);

/** The sender's earlier mails went up to last_seq: mails not yet sent are numbered from there on.
 */
void outbox_continue(struct outbox *box, uint64_t last_seq);

/** The last count numbers are for mails of an earlier life of the sender, which come next.  Nothing
 * is in the box, and nothing went out of it. */
void outbox_rewind(struct outbox *box, uint64_t count);

/** Puts in a mail that an earlier life has sent with that number, if there is room; those between
 * are answered.  mail NULL: none, but all before that number. */
void outbox_recall(struct outbox *box, const char *src, uint64_t seq, const struct mu_mail *mail);

/**
 * Copies a mail in.
 *
 * @return MU_OK; MU_FULL; MU_MALFORMED: no dst, or a field is too long
 */
MU_MUST_USE mu_result outbox_put(struct outbox *box, const char *src, const struct mu_mail *mail);

/**
 * Gives up to max mails that wait to go out, in order.
 *
 * @return how many; their strings are the box's, valid until the next put
 */
uint32_t outbox_unsent(const struct outbox *box, muster_Mail *mails, uint32_t max);

/** @return whether anything waits to go out; whether anything went out and has no answer */
bool outbox_has_unsent(const struct outbox *box);
bool outbox_has_unanswered(const struct outbox *box);

/** count mails of outbox_unsent went out. */
void outbox_sent(struct outbox *box, uint32_t count);

/** @return the end of those of the numbers from *first to last_seq that are in the box; *first:
 * out: where they begin */
uint64_t outbox_range(const struct outbox *box, uint64_t *first, uint64_t last_seq);

/** @return a mail that is in the box, if it is out and has no answer yet; else NULL */
const muster_Mail *outbox_awaited(const struct outbox *box, uint64_t seq);

/** The broker has answered for these. */
void outbox_confirm(struct outbox *box, uint64_t first_seq, uint64_t last_seq);

/** It has said its last word on these: no other broker is to take them any more. */
void outbox_end(struct outbox *box, uint64_t first_seq, uint64_t last_seq);

/**
 * The broker had these before, and says no more of them now.  They are kept: it may die before it
 * answers, and the next one has not had them.  After OUTBOX_HAD times its answer counts as lost.
 */
void outbox_had(struct outbox *box, uint64_t first_seq, uint64_t last_seq);

/** For another broker, or another life of it: all mails that are kept go out again.  A mail that is
 * over goes out as a number alone, so that no number is missing. */
void outbox_to_other(struct outbox *box);

/** All mails without an answer go out again, marked (Mail.again) if they were out: the broker may
 * be another one, and the mail may have reached its receiver. */
void outbox_again(struct outbox *box);

#endif
