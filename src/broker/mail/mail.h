/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mail.h
 * From the receivers of a mail to its boxes, what becomes of it, and what is to be on disk.
 */
#ifndef MUSTER_BROKER_MAIL_H
#define MUSTER_BROKER_MAIL_H

#include "broker/mail/journal.h"
#include "broker/mail/snapshots.h"
#include "core/address.h"
#include "core/text.h"

/* --- probes.c -------------------------------------------------------------------------------- */

/*
 * Lines that only look, on their way to a mind and back: beside all mail, and outside of every
 * step.
 *
 * A probe is known by its asker and the asker's number.  It is kept from the question until its
 * answer is out, and every question is answered, but for words that there is no room for: where no
 * agent can look, or may, it is declined, and the asker sends the line as a directive, which says
 * why it is refused.
 */

/* Words that wait for the network: one for each probe, and those that were declined. */
enum { PROBES_WORDS = 4 * MU_GLANCES_MAX };

struct probe {
    bool used;
    uint32_t asker, agent;
    uint64_t number;
    uint32_t from,
        to; /* processes: of the asker, and of the agent that is asked; MU_NONE: answered */
};

/* What a process is to be told. */
struct probes_word {
    uint32_t place;
    muster_GlanceWord word;
    uint32_t probe; /* MU_NONE: declined before it was kept */
    uint32_t asker, agent;
    uint64_t number;
};

struct probes {
    struct probe at[MU_GLANCES_MAX];
    char texts[MU_GLANCES_MAX][MU_GLANCE_BYTES_MAX]; /* of each: the line, then what it showed */
    uint32_t count;
    struct probes_word words[PROBES_WORDS]; /* in order */
    uint32_t words_count, open;             /* open: the one that broker_next has in hand */
    uint64_t asked, declined, lost;         /* counters */
};

/** Takes a word of a process. */
void probes_hear(struct broker *b, uint32_t place, const muster_Glance *probe);

/** A process is no more: what it was asked is declined, what it asked is forgotten. */
void probes_gone(struct broker *b, uint32_t place);

/**
 * Gives the first word for a process.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false: there is none
 */
bool probes_next(struct broker *b, uint32_t place, muster_Glance *out);

/** The word that was given last is out. */
void probes_sent(struct broker *b);

/* --- recipients.c ---------------------------------------------------------------------------- */

/* The receivers of a mail: names, a kind, a group, or agents that a resolver has named. */

/* The receivers of a mail, each once; too large to be cleared for every mail. */
struct recipients {
    uint32_t agents[REGISTRY_MAX];
    uint32_t count;
    uint32_t unknown; /* names that no agent ever had */
    uint32_t refused; /* agents that the sender may not direct: not among these */
    uint32_t veiled;  /* those outside the run that the sender is in; set by deliver_put */
};

/**
 * Finds the receivers of a letter. Of an address SCHEME:REST none is found; it is an unknown name
 * if there is no agent to ask about it.
 */
void recipients_of_letter(struct broker *b, const muster_Mail *letter, uint32_t sender,
                          struct recipients *to);

/** Finds the receivers of a mail: its one receiver, if another broker has named that, or the
 * letter's.
 */
void recipients_of_mail(struct broker *b, const struct mail *m, struct recipients *to);

/** Finds the bearers of names that are joined by commas, the absent ones, too. */
void recipients_of_names(struct broker *b, const char *names, uint32_t sender,
                         struct recipients *to);

/**
 * Finds the agents that a resolver has named: the sender, and unknown names, are left out; members
 * of the run can be among them only when a step ends.
 *
 * @param names  fields of content
 * @param to     out: one unknown name, if none is left: an address that no agent fits
 */
void recipients_of_answer(struct broker *b, const char *names, uint32_t sender,
                          struct recipients *to);

/**
 * @return whether the agent is outside a run that the mail's sender is in: what becomes of
 *         the mail there, and when, is no business of those inside
 */
static inline bool recipients_veils(const struct registry *r, const struct mail *m, uint32_t agent)
{
    return scope_crosses(r->agents[m->sender].scope, r->agents[agent].scope);
}

/** @return whether it is a change that names an agent inside */
bool recipients_has_member_change(const struct broker *b, const struct mail *question);

/* --- ledger.c -------------------------------------------------------------------------------- */

/*
 * What mail takes of the store is booked on its sender's account, and what is refused is counted
 * and told to watchers.
 */

/** Books a mail and its places in boxes.  @return false: refused and counted */
bool ledger_charge(struct broker *b, struct mail *m, uint32_t posts);

/** Books a mail of an earlier life of the broker.  @return false: the store is full */
bool ledger_restore(struct broker *b, struct mail *m, uint32_t posts);

/**
 * Books places in boxes outside the run that the sender is in.  They are not on its account
 * inside, where its room must not depend on acknowledgements by the wall clock.
 *
 * @return false: refused and counted; no member inside may be told
 */
bool ledger_charge_veiled(struct broker *b, struct mail *m, uint32_t posts);

/** Takes off its accounts what it has no more of: places, and with the last of them the mail. */
void ledger_settle(struct broker *b, struct mail *m);

/** Counts receivers that a mail does not reach; agent is whose box, or the broker itself. */
void ledger_refused(struct broker *b, const struct mail *m, uint32_t agent, enum quota_answer why,
                    uint64_t receivers);

/** One more event of a kind, now. */
void ledger_alert(struct broker *b, enum alert_kind kind, uint32_t agent, uint32_t sender);

/* --- outcome.c ------------------------------------------------------------------------------- */

/* What becomes of a mail, and that its sender is told. */

/** Tells an agent what became of its mails, by way of another broker if it lives beyond one. */
void outcome_tell(struct broker *b, uint32_t sender, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result);

/** The last word on a mail; what its other receivers do is not told any more. */
void outcome_end(struct broker *b, struct mail *m, muster_Outcome result);

/**
 * The last word on a mail that is in no box, and ends with it.
 *
 * @param unknown  names among its receivers that no agent ever had: that is the worse news
 */
void outcome_refuse(struct broker *b, struct mail *m, uint32_t unknown, muster_Outcome result);

/** A mail waits for a receiver, and is safe: its sender is told once. */
void outcome_stored(struct broker *b, struct mail *m);

/** One receiver is through with a mail; the last one ends it. */
void outcome_settle(struct broker *b, struct mail *m);

/** @return how long the oldest mail has waited in a box; 0 when none waits */
uint64_t outcome_oldest_ns(const struct broker *b);

/** Tells senders that pressed what became of their mail, when it is time. */
void outcome_tick(struct broker *b);

/** Refuses an admitted mail for which a step has no more room. */
void outcome_turn_away(struct broker *b, struct mail *m);

/** Drops an admitted mail that is not to take effect; its sender is told. */
void outcome_drop(struct broker *b, struct mail *m);

/** A durable mail is on disk: its sender is told, if that is to be told. */
void outcome_on_disk(struct broker *b, struct mail *m);

/** A durable mail that cannot be on disk leaves all boxes; nothing of it has gone out. */
void outcome_undo(struct broker *b, struct mail *m);

/** The agent has taken everything up to that number. */
void outcome_acknowledge(struct broker *b, uint32_t agent, uint64_t number);

/** Admits mail that is due at this time of the run. */
void outcome_admit_due(struct broker *b, uint64_t run_ns);

/** Ends the wait of mail whose time to live is over. */
void outcome_expire(struct broker *b, uint64_t mail_ns);

/** An agent has gone without a word: its receipts are kept until it is back, or for 10 s. */
void outcome_await(struct broker *b, uint32_t agent);

/** An agent that has not come back by now is not awaited any more. */
void outcome_await_tick(struct broker *b);

/* --- deliver.c ------------------------------------------------------------------------------- */

/* A mail whose receivers are known goes into their boxes, as far as there is room for it. */

/* How a mail got into its boxes. */
struct delivered {
    bool fits;     /* into each box that its sender may know of */
    bool stored;   /* some of its receivers do not take mail now */
    bool handlers; /* the broker, or a part of it, is to take it before deliver_conclude */
    uint32_t boxes;
};

/**
 * Books a mail on its sender's account with the store, puts it into every box, and tells the sender
 * what became of it at once: it may be gone then, if it is in no box.  Where there is no room for
 * those outside the run that the sender is in, they are taken out of the audience.
 *
 * @return what was done; boxes 0 and no handlers: it may have been refused, which is counted and
 * told
 */
struct delivered deliver_put(struct broker *b, struct mail *m, struct recipients *to);

/** Tells its sender what became of a mail that handlers have taken. */
void deliver_conclude(struct broker *b, struct mail *m, const struct recipients *to,
                      const struct delivered *done);

/** @return whether a mail is to wait for a time of the run that is still to come */
bool deliver_is_held(const struct broker *b, const struct mail *m);

/**
 * Puts a mail of an earlier life of the broker into its boxes.
 *
 * @param waiting  names of the receivers that have not settled it, joined by commas
 * @param left_ns  of its time to live
 * @return false: no box has room for it, and it is freed
 */
bool deliver_restore(struct broker *b, struct mail *m, const char *waiting, uint64_t left_ns);

/** Sends a mail of the broker's own to an agent, as an answer; it takes of that agent's share. */
void deliver_send(struct broker *b, uint32_t receiver, const muster_Mail *letter);

/* --- answer.c -------------------------------------------------------------------------------- */

/* What the broker says by mail is put together in b->text, and goes out from there. */

/** Begins an answer with a word. */
struct mu_text answer_begin(struct broker *b, const char *word);

/** Answers a mail; own is the agent that was asked, performative is inform, failure, refuse or
 * not-understood. */
void answer_reply(struct broker *b, uint32_t own, const struct mail *question,
                  const char *performative);

/** The broker answers with a word and one field. */
void answer_word(struct broker *b, const struct mail *question, const char *performative,
                 const char *word, const char *field);

/** Tells or asks an agent something; of the letter, what is NULL is said to be "". */
void answer_post(struct broker *b, uint32_t own, uint32_t receiver, muster_Mail *letter);

/* --- resolve.c ------------------------------------------------------------------------------- */

/*
 * Addresses SCHEME:REST that an agent resolves: the mail waits while that one is asked.
 *
 * Asked is the first agent in order of name that is there and offers the service `resolver` with
 * the attribute scheme=SCHEME; inside, only members are asked.  The question is a
 * mail of the broker in layer 2:
 *
 *   resolve  "SCHEME:REST" SENDER  ->  inform   NAME NAME ...   receivers of the mail
 *                                      failure                  the address makes no sense
 *
 * A failure, or no answer in time, is the outcome unknown-name.  Mails of a sender that come after
 * an address wait until it is resolved, so that they arrive in order; mail to the broker does not.
 */

/* How long an answer may take: outside, and inside. */
enum { RESOLVE_PATIENCE_MS = 1000, RESOLVE_PATIENCE_STEPS = 10 };

/* Mails that may wait inside, and as many outside. */
enum { RESOLVE_WAITS = QUOTA_SIDES * MU_RESOLVE_MAX };

/* A mail that waits. */
struct resolve_wait {
    struct mail *mail;
    struct mail *answer;  /* kept; NULL: none, or a failure */
    struct mu_link link;  /* of the same sender */
    struct mu_link asked; /* of those that wait for an answer, in the order of asking */
    uint32_t resolver;    /* the agent that is asked */
    uint64_t ticket;
    uint64_t since_ns, until_ns; /* mail clock */
};

struct resolve {
    struct resolve_wait waits[RESOLVE_WAITS];
    struct mu_pool pool;
    uint32_t side_count[QUOTA_SIDES];
    struct mu_list queues[REGISTRY_MAX];
    struct mu_list waits_asked;
    uint64_t soonest_ns;     /* no patience ends before this, mail clock */
    uint64_t tickets[2];     /* given for questions outside, and inside */
    uint64_t asked, refused; /* questions; answers that were not asked for, or not any more */
};

/* What is to be done with a mail that takes effect. */
enum resolve_need {
    RESOLVE_NOTHING, /* it need not wait */
    RESOLVE_WAIT,    /* its address is to be resolved, or it follows one that is */
    RESOLVE_FULL,    /* it would have to wait, and there is no room */
};

/** @return whether a mail is for no address, and follows none that waits */
static inline bool resolve_is_plain(const struct resolve *r, const struct mail *m)
{
    bool was_asked = m->only != MU_NONE; /* by the broker that it came from */
    return was_asked ||
           (r->queues[m->sender].count == 0 && mu_address_kind(m->letter.dst) != MU_ADDRESS_SCHEME);
}

/** @param m  one that is not plain */
enum resolve_need resolve_needs(const struct broker *b, const struct mail *m);

/** Keeps a mail that has to wait, booked with one place, and asks if it is the one to resolve. */
void resolve_wait(struct broker *b, struct mail *m);

/** @return whether a mail to the broker is an answer, to be given to resolve_take_answer */
bool resolve_is_answer(const struct mail *m);

/*
 * Each of the next two ends one wait, and returns the sender whose mails the caller then takes by
 * resolve_next_ready; MU_NONE: no wait ended.
 */

/** Takes the answer of a resolver. */
uint32_t resolve_take_answer(struct broker *b, struct mail *m);

/** Ends a wait for an answer that is overdue.  @param mail_ns  the mail clock; UINT64_MAX: all are
 */
uint32_t resolve_overdue(struct broker *b, uint64_t mail_ns);

/**
 * Takes the next mail of a sender that need not wait any more.
 *
 * @param answer  the resolver's answer, which the caller releases; NULL: none
 * @return it, or NULL
 */
struct mail *resolve_next_ready(struct broker *b, uint32_t sender, struct mail **answer);

#endif
