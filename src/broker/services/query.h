/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file query.h
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
#ifndef MUSTER_BROKER_QUERY_H
#define MUSTER_BROKER_QUERY_H

#include "broker/base/store.h"
#include "broker/directory/groups.h"
#include "core/text.h"

struct broker;

/* The verbs of questions and changes. */
enum query_verb {
    QUERY_LOOKUP,
    QUERY_LISTING,
    QUERY_GROUPS,
    QUERY_MEMBERS,
    QUERY_GROUP_CREATE,
    QUERY_GROUP_JOIN,
    QUERY_GROUP_LEAVE,
    QUERY_ADVERTISE,
    QUERY_WITHDRAW,
    QUERY_FIND_SERVICE,
    QUERY_SUBSCRIBE,
    QUERY_UNSUBSCRIBE,
    QUERY_VERBS
};

/** @return the verb of a mail to the broker; QUERY_VERBS: it is none */
enum query_verb query_verb(const struct mail *question);

/** Answers a mail to the broker itself. */
void query_answer(struct broker *b, const struct mail *question);

/** Answers that this is not understood. */
void query_refuse(struct broker *b, uint32_t own, const struct mail *question);

/** Answers a mail; own is who was asked, performative is inform, failure or not-understood. */
void query_reply(struct broker *b, uint32_t own, const struct mail *question,
                 const char *performative, char *content);

/* --- what the kinds of questions share; an answer's content is put together in b->text -------- */

/* Room for a field that is no name, too, so that it can be told. */
typedef char query_name[MU_FIELD_MAX + 1];

/* An answer that may not fit one mail. */
struct query_list {
    const struct mail *question;
    const char *word, *of; /* each mail begins so; of: "" for nothing */
    struct mu_text text;
};

/* Changes a line of groups or services in an agent's name.  @return why not, or NULL: done */
typedef const char *query_change(struct broker *b, const char *name, const char *agent,
                                 const struct said *said);

/** Begins an answer with a word. */
void query_begin(struct broker *b, struct mu_text *t, const char *word);

/** Sends b->text in answer to a question that was put to the broker itself. */
void query_send(struct broker *b, const struct mail *question, const char *performative);

/** Sends b->text to an agent that has asked earlier. */
void query_inform(struct broker *b, uint32_t receiver, const char *in_reply_to,
                  const char *conversation);

/** Asks an agent what stands in b->text. */
void query_ask(struct broker *b, uint32_t receiver, const char *performative,
               const char *reply_with);

/** @return the agent in whose name it is to change something, if it names one; else MU_NONE */
uint32_t query_named(const struct broker *b, const struct mail *question);

/** @return whether it is a change that names a member of the lock step */
bool query_changes_member(const struct broker *b, const struct mail *question);

/** Reads content that is one field.  @return false if it is not */
bool query_field(const char *content, struct mu_text *out);

/** Reads a question that is one field, into query_name.  @return false: answered, and counted */
bool query_read_name(struct broker *b, const struct mail *question, query_name name);

/** Reads the next field, if there is one, else "".  @return false: what is there is no field */
bool query_field_optional(const char **content, char *to, size_t size);

/**
 * Says in whose name a change is made.
 *
 * @param named  whom the change names; "": nobody
 * @return the agent's name; NULL: not in that one's, and the sender has been answered
 */
const char *query_actor(struct broker *b, const struct mail *question, const char *named);

/** Answers that the question could not be read, and counts it. */
void query_not_understood(struct broker *b, const struct mail *question);

/** Answers a change; refusal: NULL when it is done. */
void query_changed(struct broker *b, const struct mail *question, const char *refusal,
                   const char *name);

/** Makes a change that NAME or NAME AGENT asks for, and answers it. */
void query_make_change(struct broker *b, const struct mail *question, query_change *change);

void query_list_begin(struct broker *b, struct query_list *l, const struct mail *question,
                      const char *word, const char *of);

/** Sends what there is if it has no room for so many bytes more, and begins anew. */
void query_list_room(struct broker *b, struct query_list *l, size_t bytes);

/** Adds a name to a list. */
void query_list_add(struct broker *b, struct query_list *l, const char *name);

/** Sends what is left of a list, or that there is nothing. */
void query_list_end(struct broker *b, const struct query_list *l);

/* query_groups.c */
void query_groups(struct broker *b, const struct mail *question);
void query_members(struct broker *b, const struct mail *question);
void query_group_create(struct broker *b, const struct mail *question);
void query_group_join(struct broker *b, const struct mail *question);
void query_group_leave(struct broker *b, const struct mail *question);

/* query_services.c */
void query_advertise(struct broker *b, const struct mail *question);
void query_withdraw(struct broker *b, const struct mail *question);
void query_find_service(struct broker *b, const struct mail *question);
void query_subscribe(struct broker *b, const struct mail *question);
void query_unsubscribe(struct broker *b, const struct mail *question);

#endif
