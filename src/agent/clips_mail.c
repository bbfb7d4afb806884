/* SPDX-License-Identifier: Apache-2.0 */
/* Mail that comes in: mail facts, message facts and how long they stay, (getmsg). */
#include "agent/clips_value.h"
#include "muster/memory.h"

#include <string.h>

enum { MAIL_SLOTS = 10, MAIL_ID = 0, MAIL_FROM = 1, MAIL_CONTENT = 9 };

void clips_mail_install(struct mind *m)
{
    m->messages = mu_startup_alloc(sizeof *m->messages);
    struct clips_messages *all = m->messages;
    for (uint16_t i = 1; i < CLIPS_MESSAGES_MAX; i++) {
        all->at[i].newer = i + 1; /* the free ones are chained through newer */
    }
    all->free = 1;
}

static size_t mail_chain(const SYMBOL_HN *from, const void *first)
{
    return (((uintptr_t)from >> 4) * 31 + ((uintptr_t)first >> 4)) % CLIPS_CHAINS;
}

static void message_unchain(struct clips_messages *all, uint16_t index)
{
    struct clips_message *e = &all->at[index];
    uint16_t *link = &all->chains[mail_chain(e->from, e->first)];
    while (*link != index) {
        link = &all->at[*link].chain;
    }
    *link = e->chain;
    *(e->older ? &all->at[e->older].newer : &all->oldest) = e->newer;
    *(e->newer ? &all->at[e->newer].older : &all->newest) = e->older;
}

static void message_remove(struct mind *m, uint16_t index)
{
    struct clips_messages *all = m->messages;
    struct clips_message *e = &all->at[index];
    message_unchain(all, index);
    clips_percept_retract(m, &e->fact);
    DecrementSymbolCount(m->env, e->from);
    if (e->first) {
        AtomDeinstall(m->env, e->first_type, e->first);
    }
    *e = (struct clips_message){.newer = all->free};
    all->free = index;
}

void clips_mail_age(struct mind *m)
{
    struct clips_messages *all = m->messages;
    while (all->oldest && m->step - all->at[all->oldest].step >= CLIPS_MESSAGE_STEPS) {
        message_remove(m, all->oldest);
    }
}

/* A state told again: what this sender said in an earlier step with the same first word goes. */
static void message_supersede(struct mind *m, const SYMBOL_HN *from, const void *first)
{
    uint16_t next;
    for (uint16_t i = m->messages->chains[mail_chain(from, first)]; i; i = next) {
        const struct clips_message *e = &m->messages->at[i];
        next = e->chain;
        if (e->from == from && e->first == first && e->step < m->step) {
            message_remove(m, i);
        }
    }
}

static void message_add(struct mind *m, uint64_t id, SYMBOL_HN *from, struct multifield *fields)
{
    struct clips_messages *all = m->messages;
    bool some = fields->multifieldLength > 0;
    void *first = some ? fields->theFields[0].value : NULL;
    unsigned short type = some ? fields->theFields[0].type : SYMBOL;
    message_supersede(m, from, first);
    if (!all->free) {
        message_remove(m, all->oldest);
    }
    /* one fact for each mail, even when two senders say the same */
    EnvSetFactDuplication(m->env, TRUE);
    struct fact *fact = clips_percept_assert(m, m->message, fields);
    EnvSetFactDuplication(m->env, FALSE);
    if (!fact) {
        return;
    }
    uint16_t index = all->free;
    struct clips_message *e = &all->at[index];
    all->free = e->newer;
    IncrementSymbolCount(from);
    if (first) {
        AtomInstall(m->env, type, first);
    }
    uint16_t *chain = &all->chains[mail_chain(from, first)];
    *e = (struct clips_message){.fact = fact, .from = from, .first_type = type, .first = first,
                                .id = id, .step = m->step, .older = all->newest, .chain = *chain};
    *chain = index;
    *(all->newest ? &all->at[all->newest].newer : &all->oldest) = index;
    all->newest = index;
}

static void field_set(struct mind *m, struct field *to, struct clips_field f)
{
    memcpy(m->scratch, f.at, f.len);
    m->scratch[f.len] = '\0';
    switch (f.kind) {
    case CLIPS_FIELD_INTEGER:
        to->type = INTEGER;
        to->value = EnvAddLong(m->env, f.integer);
        break;
    case CLIPS_FIELD_FLOAT:
        to->type = FLOAT;
        to->value = EnvAddDouble(m->env, f.real);
        break;
    case CLIPS_FIELD_STRING:
        clips_text_unescape(m->scratch, f.at, f.len);
        to->type = STRING;
        to->value = EnvAddSymbol(m->env, m->scratch);
        break;
    case CLIPS_FIELD_INSTANCE:
    case CLIPS_FIELD_SYMBOL:
        to->type = f.kind == CLIPS_FIELD_SYMBOL ? SYMBOL : INSTANCE_NAME;
        to->value = EnvAddSymbol(m->env, m->scratch);
        break;
    case CLIPS_FIELD_END:
    case CLIPS_FIELD_BAD: break;
    }
}

/* @return the content's fields, typed; NULL: it is no list of fields */
static struct multifield *mail_fields(struct mind *m, const char *content)
{
    long count = 0;
    struct clips_field f;
    if (strlen(content) > MU_CONTENT_MAX) {
        return NULL;
    }
    for (const char *at = content; (f = clips_text_field(&at)).kind != CLIPS_FIELD_END; count++) {
        if (f.kind == CLIPS_FIELD_BAD) {
            return NULL;
        }
    }
    struct multifield *fields = CreateMultifield2(m->env, count);
    for (long i = 0; i < count; i++) {
        field_set(m, &fields->theFields[i], clips_text_field(&content));
    }
    return fields;
}

static struct multifield *mail_raw(struct mind *m, const char *content)
{
    struct multifield *fields = CreateMultifield2(m->env, 1);
    fields->theFields[0].type = STRING;
    fields->theFields[0].value = EnvAddSymbol(m->env, content);
    return fields;
}

/* A mail that rules saw as a message fact has served; any other is missed, which is said once. */
static void mail_dropped(struct mind *m, const struct fact *f)
{
    enum { LANGUAGE = 4 };
    const char *language = ValueToString(f->theProposition.theFields[LANGUAGE].value);
    if (strcmp(language, "clips") != 0 && !m->mail_dropped && m->options.ports.print) {
        m->mail_dropped = true;
        m->options.ports.print(m->options.ports.self,
                               "mail facts that no rule takes: only the latest 1024 are kept\n");
    }
}

static void mail_assert(struct mind *m, const struct mind_mail *mail, struct multifield *content)
{
    const char *const words[MAIL_SLOTS] = {
        NULL,           mail->src,        m->options.name,   mail->performative, mail->language,
        mail->ontology, mail->reply_with, mail->in_reply_to, mail->conversation, NULL};
    struct fact *f = EnvCreateFact(m->env, m->mail);
    struct field *slots = f->theProposition.theFields;
    slots[MAIL_ID].type = INTEGER;
    slots[MAIL_ID].value = EnvAddLong(m->env, (long long)mail->id);
    for (size_t i = MAIL_FROM; i < MAIL_CONTENT; i++) {
        slots[i].type = SYMBOL;
        slots[i].value = EnvAddSymbol(m->env, words[i][0] ? words[i] : "nil");
    }
    slots[MAIL_CONTENT].type = MULTIFIELD;
    slots[MAIL_CONTENT].value = content;
    struct fact **slot = &m->mails[m->mail_next];
    m->mail_next = (m->mail_next + 1) % CLIPS_MAILS_MAX;
    if (*slot && EnvFactExistp(m->env, *slot)) {
        mail_dropped(m, *slot);
    }
    clips_percept_retract(m, slot);
    *slot = EnvAssert(m->env, f);
    if (*slot) {
        EnvIncrementFactCount(m->env, *slot);
    }
}

void mind_take_mail(struct mind *m, const struct mind_mail *mail)
{
    struct mind_mail letter = *mail;
    bool clips = mail->language[0] == '\0' || strcmp(mail->language, "clips") == 0;
    letter.language = clips ? "clips" : mail->language;
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    EnvIncrementGCLocks(m->env);
    struct multifield *fields = clips ? mail_fields(m, mail->content) : NULL;
    if (fields) {
        struct multifield *copy = CopyMultifield(m->env, fields);
        message_add(m, mail->id, EnvAddSymbol(m->env, mail->src), copy);
    } else {
        fields = mail_raw(m, mail->content);
    }
    mail_assert(m, &letter, fields);
    EnvDecrementGCLocks(m->env);
    clips_env_leave(m);
}

/* The message fact of a mail goes with it. */
static void mail_forget_message(struct mind *m, const struct field *id)
{
    if (id->type != INTEGER) {
        return;
    }
    uint64_t number = (uint64_t)((const struct integerHashNode *)id->value)->contents;
    for (uint16_t i = m->messages->oldest; i; i = m->messages->at[i].newer) {
        if (m->messages->at[i].id == number) {
            message_remove(m, i);
            return;
        }
    }
}

void clips_mail_getmsg(void *env, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    struct fact *f = EnvGetNextFactInTemplate(env, m->mail, NULL);
    if (!f) {
        EnvSetMultifieldErrorValue(env, out);
        return;
    }
    const struct field *slots = f->theProposition.theFields;
    const struct multifield *content = slots[MAIL_CONTENT].value;
    long count = content->multifieldLength;
    struct multifield *fields = EnvCreateMultifield(env, count + 1);
    fields->theFields[0].type = slots[MAIL_FROM].type;
    fields->theFields[0].value = slots[MAIL_FROM].value;
    memcpy(&fields->theFields[1], content->theFields, (size_t)count * sizeof content->theFields[0]);
    mail_forget_message(m, &slots[MAIL_ID]);
    EnvRetract(env, f);
    clips_value_multifield(out, fields);
}
