/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mail.h
 * From the receivers of a mail to its boxes, what becomes of it, and what is to be on disk.
 */
#ifndef MUSTER_BROKER_MAIL_H
#define MUSTER_BROKER_MAIL_H

#include "broker/directory/directory.h"
#include "bus/bus.h"
#include "core/text.h"
#include "wire.h"

struct broker;

/* --- snapshots.c ----------------------------------------------------------------------------- */

/*
 * Snapshots of agents that are on their way, and the words about them.
 *
 * A snapshot is kept from the moment at which its source hands it in until the agent lives at
 * another process, or has set out anew, or stayed.  As long as no agent has the name, a host that
 * restores agents may ask for it.  docs/mobility.md has the order of events.
 *
 * Inside a run by steps the snapshot store holds the step while a snapshot is under way, and seats
 * the agent itself. So it does with agents that are new (clones, and those that are launched): of
 * them it keeps nothing once they live.
 */

enum { SNAPSHOT_WORDS = 4 * MU_CAPSULES_MAX };

enum snapshot_phase {
    SNAPSHOT_FREE,
    SNAPSHOT_STEP, /* it came in a step that has not ended */
    SNAPSHOT_SENT, /* its host has it, or is about to, and has said nothing */
    SNAPSHOT_KEPT  /* nothing is awaited */
};

struct snapshot {
    enum snapshot_phase phase;
    char name[MU_NAME_MAX + 1];
    uint32_t agent; /* of that name; MU_NONE: it is new */
    uint32_t
        asker; /* the agent that wants the journey: itself, or the one that asks for a new one */
    muster_State state; /* that it has there */
    uint64_t epoch;
    char home[MU_PROCESS_MAX + 1]; /* the process that it set out from, dead or alive */
    uint32_t source, target;       /* places; MU_NONE: not known, or no more */
    uint32_t host;                 /* the agent that it wants to go to */
    bool in_step;                  /* it came with the answer to a step */
    bool seated;                   /* a step has given its name to the target, and said so */
    bool holds;                    /* the step waits for it */
    uint64_t until_ns;             /* the host's word on it is awaited for so long */
    bool unsaved;                  /* the disk is to be told that it is there, or that it is free */
    size_t len;
    char *text; /* MU_CAPSULE_MAX; snapshot header and snapshot */
};

/* What a process is to be told. */
struct snapshot_word {
    uint32_t place;
    char process[MU_PROCESS_MAX + 1]; /* whose place that is */
    muster_TripWord word;
    char name[MU_NAME_MAX + 1]; /* of the agent */
    uint32_t asker;             /* of a new one; MU_NONE: of another, or to its host */
    uint32_t host, at;          /* at: the place where it lives */
    uint64_t epoch;
    uint32_t snapshot; /* of arrive */
    char reason[MU_FIELD_MAX + 1];
};

struct snapshots {
    struct snapshot snapshots[MU_CAPSULES_MAX];
    uint32_t count, holding;                    /* snapshots; those that the step waits for */
    struct snapshot_word words[SNAPSHOT_WORDS]; /* in order */
    uint32_t words_count;
    uint32_t open;                                 /* the word that dispatch_next has in hand */
    uint64_t kept, taken, refused, lost, restored; /* counters */
};

void snapshots_init(struct snapshots *d);

/** A process is no more; what it was to be told waits, for it may have been slow only. */
void snapshots_process_gone(struct broker *b, uint32_t place);

/** An agent was seated, or said something of itself: its snapshot may be of no use any more.  That
 * of one that a step has seated is kept until it has answered a step. */
void snapshots_review(struct broker *b, uint32_t agent);

/** An agent has answered a step, or acknowledged mail, from this process: if it has come there, it
 * lives there, and what it was before is of no use any more. */
void snapshots_heard(struct broker *b, uint32_t agent, uint32_t place);

/** @return whether what a process says of an agent is of before it was taken from there, or of
 *          after it will have been seated there: neither is a claim on the name.  A registration
 *          says nothing of the step that it was written in, so that one of a run may be of
 *          any life that a name has had in it */
bool snapshots_overrule(const struct broker *b, uint32_t agent, uint32_t place,
                        const struct presence *is);

/** @return whether a copy of an agent is kept here */
bool snapshots_keep(const struct broker *b, uint32_t agent);

/** @return whether a later copy of an agent that no process has is kept here */
bool snapshots_have_later(const struct broker *b, uint32_t agent, uint64_t epoch);

/** @return when transfer_tick is needed next, or UINT64_MAX */
uint64_t snapshots_deadline_ns(const struct broker *b);

/**
 * Gives the first word for a process.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false: there is none
 */
bool snapshots_next(struct broker *b, uint32_t place, muster_Trip *out);

/** The word that was given last is out. */
void snapshots_sent(struct broker *b);

/** Takes in a snapshot of an earlier life.  @return false: there is no room, or it is malformed */
bool snapshots_restore(struct broker *b, uint32_t agent, uint64_t epoch, const char *text);

/** A host has said something of a snapshot that it was handed. */
struct snapshot *snapshots_answered_by(struct broker *b, uint32_t place, const muster_Trip *trip);

void snapshots_drop(struct broker *b, struct snapshot *c);

struct snapshot *snapshots_add(struct broker *b, uint32_t agent, const char *name, uint64_t epoch,
                               const char *text);

/** It stays where it is, which the source hears; the snapshot is kept until the source has said
 * that it goes on.  No process takes back a new agent. */
void snapshots_refuse(struct broker *b, struct snapshot *c, const char *reason);

void snapshots_send(struct broker *b, struct snapshot *c);

/** It is to drop the copy that it has made. */
void snapshots_refuse_copy(struct broker *b, uint32_t place, const char *name, uint64_t epoch,
                           const char *reason);

void snapshots_tell(struct broker *b, const struct snapshot *c, uint32_t place, muster_TripWord say,
                    const char *reason);

/** A word without a receiver, or one too many, is lost; a process that waits for it has a time
 * limit. */
void snapshots_say(struct broker *b, const struct snapshot_word *word);

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
    uint32_t from, to; /* places: of the asker, and of the agent that is asked; MU_NONE: answered */
    char *text;        /* MU_GLANCE_BYTES_MAX: the line, then what it showed */
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
    uint32_t count;
    struct probes_word words[PROBES_WORDS]; /* in order */
    uint32_t words_count, open;             /* open: the one that dispatch_next has in hand */
    uint64_t asked, declined, lost;         /* counters */
};

void probes_init(struct probes *g);

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

/* --- journal.c ------------------------------------------------------------------------------- */

/*
 * What must be on disk before any process is told.
 *
 * The broker's parts say what has changed; the owner of the disk takes it from here, in one
 * transaction, and says how that went:
 *
 *     while (journal_wanted(b, &level)) {       at most once a round, before anything is delivered
 *         begin; while (journal_next(b, &entry)) write entry; commit;
 *         durable_committed(b, ok, now_ns);
 *     }
 *
 * Nothing is copied: a change is a mark on a mail, a name or a line, and what is written is how
 * that stands at the commit.  So the journal is bounded by what it keeps account of, and a mail
 * that came and went in one round costs nothing.
 *
 * After a failure new durable mail is refused and the rest stays marked; it is tried again a
 * second later.
 */

enum {
    JOURNAL_BUCKETS = 65536,
    JOURNAL_WAITING_BYTES = REGISTRY_MAX * (MU_NAME_MAX + 1) + 32,
    JOURNAL_RESERVE = 1 << 20, /* numbers of a sender that are reserved at once */
};

/* No row, stamp or incarnation of a broker goes so far; what stands in a file may. */
#define JOURNAL_NUMBER_MAX ((uint64_t)INT64_MAX / 2)

enum journal_kind {
    JOURNAL_AGENT,    /* name, kind, durable_seq, failed_seq, reserved_seq */
    JOURNAL_MAIL,     /* row, letter, waiting, expires_wall_ns */
    JOURNAL_WAITING,  /* row, waiting: some receivers have settled it */
    JOURNAL_GONE,     /* row to last_row: these are not waited for */
    JOURNAL_LINE,     /* lines, slot, line; present false and no key: the slot is free */
    JOURNAL_RESET,    /* lines: all earlier ones of that kind are void */
    JOURNAL_CLOCK,    /* run_wall_ns */
    JOURNAL_SNAPSHOT, /* name, epoch, snapshot */
};

/* One row on its way to the disk, or from it. */
struct journal_entry {
    enum journal_kind kind;
    const char *name; /* of an agent */
    muster_Kind agent_kind;
    uint64_t durable_seq, failed_seq, reserved_seq;
    uint64_t row, last_row;
    muster_Mail letter;
    const char *waiting;      /* names, joined by commas; behind a slash, pool_mail_standing */
    uint64_t expires_wall_ns; /* nanoseconds since 1970; 0: never */
    enum lines_kind lines;
    uint32_t slot;
    struct line_word line;
    uint64_t run_wall_ns; /* when the run's time was 0; 0: no run goes on by the wall */
    uint64_t epoch;
    const char *snapshot; /* of that agent; "": it has none any more */
};

struct journal_slots {
    uint32_t *marked; /* NULL: nothing is kept */
    bool *is_marked;  /* for each slot */
    uint32_t count;
    bool reset; /* lines of an earlier life are still on disk */
};

/* Where journal_next goes on. */
struct journal_cursor {
    uint32_t agent;
    struct mail *mail;
    enum lines_kind lines;
    uint32_t line;
    uint32_t snapshot;
    bool clock_done, begun;
};

struct journal {
    bool on;
    bool failing;
    bool awaits;        /* agents that are not there may still come back: see struct agent */
    uint64_t awaits_ns; /* until then, the first of them */
    uint64_t retry_ns;
    uint64_t rows;             /* the last row of a mail */
    struct mail *first, *last; /* mails that are marked, in order of routing */
    uint32_t *agents;          /* marked names: REGISTRY_MAX */
    uint32_t agents_count;
    struct journal_slots slots[LINES_KINDS];
    uint64_t run_wall_ns;  /* as it is on disk */
    struct mail **buckets; /* durable mails by sender and number: JOURNAL_BUCKETS */
    struct journal_cursor at;
    char *text;                 /* for the names of a mail's receivers */
    uint64_t commits, failures; /* counters */
};

void journal_init(struct journal *j, bool on);

/* --- for the parts of the broker -------------------------------------------------------------- */

/** @return whether durable mail can be taken now */
bool journal_takes(const struct broker *b);

/** A mail stands in boxes.  It is marked if it is durable, and with it what its sender has sent
 * before, and still waits; other mail is passed over. */
void journal_put(struct broker *b, struct mail *m);

/** An agent has acknowledged a mail. */
void journal_acknowledged(struct broker *b, uint32_t agent, const struct mail *m);

/**
 * A receiver need not remember more than a window of mails that may come again, so no more go out
 * before its acknowledgements are on disk.
 *
 * @return how many mails of the store the agent may be handed now
 */
uint32_t journal_room(const struct broker *b, uint32_t agent);

/** A mail was not delivered, whether it stood in boxes or not: later lives do not say that it was.
 */
void journal_failed(struct broker *b, uint32_t sender, const muster_Mail *letter);

/** A receiver is through with a mail: m->unsettled says how many are not.  Call before the last
 *  use of it ends. */
void journal_settled(struct broker *b, struct mail *m);

/** A name is there, or its kind has changed. */
void journal_agent(struct broker *b, uint32_t agent);

/** A sender's mails have come up to another number. */
void journal_seq(struct broker *b, uint32_t agent);

/** A durable mail that is on disk can be found. */
void journal_enter(struct journal *j, struct mail *m);

/** @return a durable mail that waits, or NULL */
struct mail *journal_find(const struct journal *j, uint32_t sender, uint64_t seq);

/** @return the groups or the services */
struct lines *journal_table(struct broker *b, enum lines_kind lines);

/** A line has changed, come or gone. */
void journal_line_changed(struct broker *b, enum lines_kind lines, uint32_t slot);

/* --- for the owner of the disk ---------------------------------------------------------------- */

/**
 * @param level  out: what the transaction has to survive
 * @return whether there is anything to write now
 */
bool journal_wanted(struct broker *b, muster_Level *level);

/** Gives the next change, valid until the next call.  @return false when that was all */
bool journal_next(struct broker *b, struct journal_entry *entry);

/** Puts a mail last into the list of what the next commit writes. */
void journal_list(struct journal *j, struct mail *m);

void journal_remove(struct journal *j, struct mail *m);

/** When the run that goes on by the wall was at 0; the time of steps stands still without us. */
uint64_t journal_run_wall_ns(const struct broker *b);

/* --- recipients.c ---------------------------------------------------------------------------- */

/* The receivers of a mail: names, a kind, a group, or agents that a resolver has named. */

/* The verbs of questions and changes. */
enum recipients_verb {
    VERB_LOOKUP,
    VERB_LISTING,
    VERB_GROUPS,
    VERB_MEMBERS,
    VERB_GROUP_CREATE,
    VERB_GROUP_JOIN,
    VERB_GROUP_LEAVE,
    VERB_ADVERTISE,
    VERB_WITHDRAW,
    VERB_FIND_SERVICE,
    VERB_SUBSCRIBE,
    VERB_UNSUBSCRIBE,
    VERB_VERBS
};

/** @return the verb of a mail to the broker; VERB_VERBS: it is none */
enum recipients_verb recipients_verb(const struct mail *question);

/* The receivers of a mail, each once; too large to be cleared for every mail. */
struct recipients {
    uint32_t agents[REGISTRY_MAX];
    uint32_t count;
    uint32_t unknown; /* names that no agent ever had */
    uint32_t refused; /* agents that the sender may not direct: not among these */
    uint32_t veiled;  /* those outside the run that the sender is in; set by deliver_book */
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
bool recipients_veils(const struct broker *b, const struct mail *m, uint32_t agent);

/** Takes those outside out of it: they are not reached. */
void recipients_unveil(const struct broker *b, const struct mail *m, struct recipients *to);

/** @return the agent in whose name it is to change something, if it names one; else MU_NONE */
uint32_t recipients_named(const struct broker *b, const struct mail *question);

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

/** Tells senders that pressed what became of their mail, when it is time. */
void outcome_tick(struct broker *b);

/* --- settle.c -------------------------------------------------------------------------------- */

/** Refuses an admitted mail for which a step has no more room. */
void settle_turn_away(struct broker *b, struct mail *m);

/** Drops an admitted mail that is not to take effect; its sender is told. */
void settle_drop(struct broker *b, struct mail *m);

/** A durable mail is on disk: its sender is told, if that is to be told. */
void settle_stored(struct broker *b, struct mail *m);

/** A durable mail that cannot be on disk leaves all boxes; nothing of it has gone out. */
void settle_undo(struct broker *b, struct mail *m);

/** The agent has taken everything up to that number. */
void settle_acknowledge(struct broker *b, uint32_t agent, uint64_t number);

/** Admits mail that is due at this time of the run. */
void settle_admit_due(struct broker *b, uint64_t run_ns);

/** Ends the wait of mail whose time to live is over. */
void settle_expire(struct broker *b, uint64_t mail_ns);

/** An agent has gone without a word: its receipts are kept until it is back, or for 10 s. */
void settle_await(struct broker *b, uint32_t agent);

/** An agent that has not come back by now is not awaited any more. */
void settle_tick(struct broker *b);

/** @return when settle_tick, or a failed commit, is due, or UINT64_MAX */
uint64_t settle_deadline_ns(const struct broker *b);

/* --- deliver.c ------------------------------------------------------------------------------- */

/* A mail whose receivers are known goes into their boxes, as far as there is room for it. */

/**
 * Books a mail on its sender's account with the store.  Where there is no room for those outside
 * the run that the sender is in, they are taken out of the audience.
 *
 * @return false: refused, counted, told, and freed
 */
bool deliver_book(struct broker *b, struct mail *m, struct recipients *to);

/* How a mail got into its boxes. */
struct delivered {
    bool held;   /* until a time of the run */
    bool fits;   /* into each box that its sender may know of */
    bool stored; /* some of its receivers do not take mail now */
};

/** Puts a booked mail into every box; keeps one use of it for deliver_conclude. */
struct delivered deliver_put(struct broker *b, struct mail *m, const struct recipients *to);

/** Tells the sender what became of it at once, and gives back the use that deliver_put kept. */
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

/** Answers a mail; own is the agent that was asked, performative is inform, failure or
 * not-understood. */
void answer_reply(struct broker *b, uint32_t own, const struct mail *question,
                  const char *performative, char *content);

/** Begins an answer with a word. */
void answer_begin(struct broker *b, struct mu_text *t, const char *word);

/** Sends b->text in answer to a question that was put to the broker itself. */
void answer_send(struct broker *b, const struct mail *question, const char *performative);

/** Sends b->text to an agent that has asked earlier. */
void answer_inform(struct broker *b, uint32_t receiver, const char *in_reply_to,
                   const char *conversation);

/** Asks an agent what stands in b->text. */
void answer_ask(struct broker *b, uint32_t receiver, const char *performative,
                const char *reply_with);

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

enum resolve_state {
    RESOLVE_FOLLOWS, /* its receivers are known, or none resolves them */
    RESOLVE_ASKED,
    RESOLVE_ANSWERED,
};

/* A mail that waits. */
struct resolve_wait {
    struct mail *mail;
    struct mail *answer;  /* kept; NULL: none, or a failure */
    struct mu_link link;  /* of the same sender */
    struct mu_link asked; /* of those that wait for an answer, in the order of asking */
    uint32_t resolver;    /* the agent that is asked */
    uint8_t state;        /* enum resolve_state */
    uint64_t ticket;
    uint64_t since_ns, until_ns; /* mail clock */
};

struct resolve {
    struct resolve_wait *waits; /* MU_RESOLVE_MAX inside, and as many outside */
    struct mu_pool pool;
    uint32_t side_count[QUOTA_SIDES];
    struct mu_list *queues; /* of each agent of the registry */
    struct mu_list waits_asked;
    uint64_t soonest_ns;     /* no patience ends before this, mail clock */
    uint64_t tickets[2];     /* given for questions outside, and inside */
    uint64_t asked, refused; /* questions; answers that were not asked for, or not any more */
};

void resolve_init(struct resolve *r, uint32_t agents);

/* What is to be done with a mail that takes effect. */
enum resolve_need {
    RESOLVE_NOTHING, /* it need not wait */
    RESOLVE_WAIT,    /* its address is to be resolved, or it follows one that is */
    RESOLVE_FULL,    /* it would have to wait, and there is no room */
};

enum resolve_need resolve_needs(const struct broker *b, const struct mail *m);

/** Keeps a mail that has to wait, booked with one place, and asks if it is the one to resolve. */
void resolve_wait(struct broker *b, struct mail *m);

/** @return whether a mail to the broker is an answer, to be given to resolve_take_answer */
bool resolve_is_answer(const struct mail *m);

/*
 * Each of the next three ends one wait, and returns the sender whose mails the caller then takes by
 * resolve_next_ready; MU_NONE: no wait ended.
 */

/** Takes the answer of a resolver. */
uint32_t resolve_take_answer(struct broker *b, struct mail *m);

/** Ends a wait for an answer that is overdue.  @param mail_ns  the mail clock */
uint32_t resolve_overdue(struct broker *b, uint64_t mail_ns);

/** Ends a wait, because a run begins: no question from before has a place in it. */
uint32_t resolve_give_up(struct broker *b);

/**
 * Takes the next mail of a sender that need not wait any more.
 *
 * @param answer  the resolver's answer, which the caller releases; NULL: none
 * @return it, or NULL
 */
struct mail *resolve_next_ready(struct broker *b, uint32_t sender, struct mail **answer);

/** @return when resolve_overdue is needed next, mail clock; UINT64_MAX: never */
uint64_t resolve_deadline_mail_ns(const struct broker *b);

#endif
