/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file services.h
 * What the broker answers by mail, news of changes, and the way of one mail.
 */
#ifndef MUSTER_BROKER_SERVICES_H
#define MUSTER_BROKER_SERVICES_H

#include "broker/delivery/delivery.h"

/* --- metrics.c ------------------------------------------------------------------------------- */

/*
 * The parts of the broker and what each counts: one table for the answer to `state`, for the topic
 * PartStatus and for docs/reference/counters.md.
 */

/*
 * What a part of the broker has counted, for agents that ask it.
 *
 *   state  to broker.PART  ->  inform   PART COUNTER NUMBER COUNTER NUMBER ...
 *          to broker       ->  inform   broker PART.COUNTER NUMBER ...
 *          inside          ->  failure: see scope_refuses_counters()
 *
 * A member of a run is not told: counters depend on the wall clock.
 */

/* The broker's parts, by their index in the white pages; 0 there is the broker itself. */
enum metrics_part {
    PART_NAMES = 1,
    PART_MAIL,
    PART_DELIVERY,
    PART_GROUPS,
    PART_SERVICES,
    PART_TRUST,
    PART_JOURNAL,
    PART_FEDERATION,
    PARTS_END /* one more than the last */
};

/* Counters of all parts together. */
enum { METRICS_MAX = 128 };

struct metric {
    enum metrics_part part;
    const char *name;   /* a CLIPS symbol */
    const char *counts; /* what, and in which unit, for people */
    const char *was;    /* its name in the version before; NULL: the same */
    bool drifts;        /* changes with time alone: no news in itself */
    size_t offset;      /* of the number in struct broker */
    size_t size;        /* of it: 4 or 8; 0: asked for by read */
    uint64_t (*read)(const struct broker *b);
};

/** @return the word for a part, without "broker." */
const char *metrics_part_name(uint32_t part);

/** @return the index-th counter; the table is in order of part; NULL past the last */
const struct metric *metrics_at(size_t index);

uint64_t metrics_value(const struct broker *b, const struct metric *c);

/** Prints the table as Markdown to standard output. */
void metrics_print(void);

/** Answers a question for the state of the broker or of one of its parts. */
void metrics_answer(struct broker *b, uint32_t own, const struct mail *question);

/* --- request.c ------------------------------------------------------------------------------- */

/*
 * Questions to the pages, and changes of them: mails to `broker` in layer 2, answered by mail.
 *
 *   lookup NAME         ->  inform   member NAME KIND STATE BROKER HOST PID
 *                           failure  unknown-name NAME
 *   listing             ->  inform   members NAME NAME ...
 *   groups              ->  inform   groups GROUP GROUP ...
 *   members GROUP       ->  inform   members-of GROUP NAME NAME ...
 *                           failure  unknown-group GROUP
 *   find-service QUERY  ->  inform   services SERVICE AGENT "ATTRIBUTES" SERVICE AGENT ...
 *   subscribe QUERY     ->  inform   subscribe "QUERY"; and then, as often as it happens,
 *                           inform   came SERVICE AGENT "ATTRIBUTES"
 *                           inform   went SERVICE AGENT
 *   unsubscribe QUERY   ->  inform   unsubscribe "QUERY"
 *
 * A list that does not fit one mail comes in several.  Changes concern the sender, or the agent
 * that they name, if the sender may speak for it; they are answered only when reply-with is set:
 *
 *   group-create GROUP, group-join GROUP [AGENT], group-leave GROUP [AGENT],
 *   withdraw SERVICE [AGENT], advertise SERVICE ["ATTRIBUTES" [SECONDS [AGENT]]]
 *                       ->  inform   the change and its name
 *                           failure  a word that says why not, and the name
 *
 * What cannot be read is answered with not-understood, question or change.
 */

/* --- what the kinds of questions share; an answer's content is put together in b->text -------- */

/* Room for a field that is no name, too, so that it can be told. */
typedef char request_name[MU_FIELD_MAX + 1];

/* An answer that may not fit one mail. */
struct request_list {
    const struct mail *question;
    struct mu_text text;
    size_t head; /* so many of its bytes begin each mail */
};

/* Changes a line of groups or services in an agent's name.  @return why not, or NULL: done */
typedef const char *request_change(struct lines *table, const char *name, const char *agent,
                                   const struct said *said);

/** Reads content that is one field.  @return false if it is not */
bool request_field(const char *content, struct mu_text *out);

/** Reads the next field, if there is one, else "".  @return false: what is there is no field */
bool request_field_optional(const char **content, char *to, size_t size);

/**
 * Says in whose name a change is made.
 *
 * @param named the agent that the change names; "": none
 * @return the agent's name; NULL: not in that one's, and the sender has been answered
 */
const char *request_actor(struct broker *b, const struct mail *question, const char *named);

/** Answers that the question could not be read, and counts it. */
void request_not_understood(struct broker *b, const struct mail *question);

/** A change is news, and is answered; refusal: NULL when it is done. */
void request_changed(struct broker *b, const struct mail *question, const char *refusal,
                     const char *name);

void request_list_begin(struct broker *b, struct request_list *l, const struct mail *question,
                        const char *word, const char *of);

/** Sends what there is if it has no room for so many bytes more, and begins anew. */
void request_list_room(struct broker *b, struct request_list *l, size_t bytes);

/** Sends what is left of a list, or that there is nothing. */
void request_list_end(struct broker *b, const struct request_list *l);

/* --- request_services.c ---------------------------------------------------------------------- */

void request_advertise(struct broker *b, const struct mail *question);
void request_find_service(struct broker *b, const struct mail *question);
void request_subscribe(struct broker *b, const struct mail *question);
void request_unsubscribe(struct broker *b, const struct mail *question);

/* --- directive.c ----------------------------------------------------------------------------- */

/*
 * What the broker can be told to do while it runs: `muster do broker '(WORD VALUE...)'`.
 *
 *   (delivery-interval MS)  ->  inform   delivery-interval MS
 *   a wrong value           ->  failure  "delivery-interval: expected ..."
 *   another word            ->  failure  "the broker carries out: ..."
 */

/** Carries out a directive that the policy has let through, and answers it. */
void directive_take(struct broker *b, uint32_t own, const struct mail *m);

/* --- handlers.c ------------------------------------------------------------------------------ */

/*
 * Mail to the broker itself and to its parts: directives, questions for a state, questions to the
 * white pages.
 */

/** Does what the mail wants, and answers it; own is its receiver. */
void handlers_take(struct broker *b, uint32_t own, struct mail *m);

/* --- notify.c -------------------------------------------------------------------------------- */

/** Something may have changed: processes are woken, subscribers are sent what is news to them. */
void notify_tell(struct broker *b);

/** Tells a subscriber all that is news to it; silently: it counts as told. */
void notify_review(struct broker *b, struct subscription *s, bool silently);

/** An agent has come or gone. */
void notify_presence(struct broker *b, uint32_t agent);

/** Ends leases.  @param mail_ns  the mail clock */
void notify_expire(struct broker *b, uint64_t mail_ns);

/** A run that goes by steps begins, or (begins false) has ended: what stands now is what is seen in
 * it. */
void notify_run(struct broker *b, bool begins);

/* --- route.c --------------------------------------------------------------------------------- */

/* A mail's way: in from the wire, and to the boxes of its receivers. */

/** Takes a mail of an agent from the wire, and puts it on its way, or keeps it until a step ends.
 *  What is not taken is counted, and its sender told. */
void route_letter(struct broker *b, uint32_t sender, const muster_Mail *letter,
                  enum steps_effect effect);

/** Puts an admitted mail on its way.  @return false if its sender may not send such a mail */
bool route_mail(struct broker *b, struct mail *m);

/** Ends all waits for answers that are overdue, as resolve_overdue says, and routes the mails that
 * waited. */
void route_resolve_expire(struct broker *b, uint64_t mail_ns);

/** Mail that came from outside sets out: now, or with the end of the step, if it meets the run. */
void route_from_outside(struct broker *b, struct mail *m);

#endif
