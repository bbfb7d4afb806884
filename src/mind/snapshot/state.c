/* SPDX-License-Identifier: Apache-2.0 */
/* The C state of a mind in a snapshot: percept, mail, handlers, events, random numbers. */
#include "mind/snapshot/fields.h"

#include <string.h>

/* --- numbers ---------------------------------------------------------------------------------- */

static void floats_save(struct mu_text *out, const char *word, const float *at, size_t count)
{
    mu_text_format(out, "%s %zu", word, count);
    for (size_t i = 0; i < count; i++) {
        snapshot_add_real(out, (double)at[i]);
    }
    mu_text_add(out, "\n");
}

static bool floats_load(struct snapshot *c, const char *word, float *to, size_t *count, size_t most)
{
    uint64_t wanted;
    double x;
    if (!snapshot_line(c, word)) {
        return true; /* it is of an earlier version, without such a list */
    }
    if (!snapshot_count(c, &wanted) || wanted > most) {
        return false;
    }
    for (*count = 0; *count < wanted; (*count)++) {
        if (!snapshot_real(c, &x)) {
            return false;
        }
        to[*count] = (float)x;
    }
    return snapshot_end(c);
}

static bool counts_load(struct snapshot *c, const char *word, uint64_t *to, size_t count)
{
    if (!snapshot_line(c, word)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (!snapshot_count(c, &to[i])) {
            return false;
        }
    }
    return snapshot_end(c);
}

/* Reads the index of a fact that C code holds, or that rules have retracted. */
static bool fact_load(struct snapshot *c, struct fact **fact)
{
    long long index;
    if (!snapshot_whole(c, &index)) {
        return false;
    }
    *fact = snapshot_fact(c, index);
    if (*fact) {
        EnvIncrementFactCount(c->mind->env, *fact);
    }
    return *fact || index == SNAPSHOT_NONE;
}

static void facts_save(struct mind *m, struct mu_text *out, struct fact *const *facts, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        mu_text_format(out, " %lld", snapshot_index(m, facts[i]));
    }
}

static bool facts_load(struct snapshot *c, struct fact **facts, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!fact_load(c, &facts[i])) {
            return false;
        }
    }
    return true;
}

/* --- percept ---------------------------------------------------------------------------------- */

static void field_save(struct mu_text *out, const struct mu_field *f, const char *element)
{
    double real;
    uint32_t bits;
    if (f->type == MU_FIELD_double) {
        memcpy(&real, element + f->at, sizeof real);
        snapshot_add_real(out, real);
    } else {
        memcpy(&bits, element + f->at, sizeof bits);
        mu_text_format(out, f->type == MU_FIELD_int32_t ? " %d" : " %u", bits);
    }
}

static bool field_load(struct snapshot *c, const struct mu_field *f, char *element)
{
    double real;
    long long whole;
    if (f->type == MU_FIELD_double) {
        bool good = snapshot_real(c, &real);
        memcpy(element + f->at, &real, sizeof real);
        return good;
    }
    bool good = snapshot_whole(c, &whole);
    memcpy(element + f->at, &(uint32_t){(uint32_t)whole}, sizeof(uint32_t));
    return good;
}

/* Writes a plain list as one line, and each record as one. */
static void list_save(struct mind *m, struct mu_text *out, const struct mu_channel *c)
{
    size_t count;
    const char *element = mu_channel_list(c, &inputs_of(m)->percept, &count);
    if (c->plain) {
        floats_save(out, c->fact, (const float *)(const void *)element, count);
        return;
    }
    for (size_t i = 0; i < count; i++, element += c->bytes) {
        mu_text_add(out, c->fact);
        for (size_t k = 0; k < c->field_count; k++) {
            field_save(out, &c->fields[k], element);
        }
        mu_text_add(out, "\n");
    }
}

static bool records_load(struct snapshot *c, const struct mu_channel *channel, char *element,
                         size_t *count)
{
    for (*count = 0; snapshot_line(c, channel->fact); (*count)++) {
        bool good = *count < channel->most;
        for (size_t k = 0; good && k < channel->field_count; k++) {
            good = field_load(c, &channel->fields[k], element);
        }
        if (!good || !snapshot_end(c)) {
            return false;
        }
        element += channel->bytes;
    }
    return true;
}

static bool lists_load(struct snapshot *c)
{
    bool good = true;
    for (size_t i = 0; i < MU_CHANNEL_COUNT && good; i++) {
        const struct mu_channel *channel = &mu_channels[i];
        void *elements = inputs_of(c->mind)->lists[i].elements;
        size_t count = 0;
        good = channel->plain ? floats_load(c, channel->fact, elements, &count, channel->most)
                              : records_load(c, channel, elements, &count);
        mu_channel_set(channel, &inputs_of(c->mind)->percept, elements, count);
    }
    return good;
}

static void percept_save(struct mind *m, struct mu_text *out)
{
    const struct mu_percept *p = &inputs_of(m)->percept;
    mu_text_format(out, "percept %d %llu %d %u %u", inputs_of(m)->body,
                   (unsigned long long)p->time_ns, p->stalled, p->bumpers, p->gripper);
    for (size_t i = 0; i < MU_READING_COUNT; i++) {
        if (mu_readings[i].type == MU_FIELD_double) {
            field_save(out, &mu_readings[i], (const char *)p);
        }
    }
    mu_text_add(out, "\n");
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        list_save(m, out, &mu_channels[i]);
    }
    mu_text_format(out, "percept-facts %d %lld", inputs_of(m)->ring_unseen,
                   inputs_of(m)->ring_number);
    facts_save(m, out, &inputs_of(m)->position_fact, 1);
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        facts_save(m, out, inputs_of(m)->lists[i].facts, percept_fact_count(m, i));
    }
    mu_text_add(out, "\n");
    if (inputs_of(m)->time_fact) {
        mu_text_add(out, "time-fact");
        facts_save(m, out, &inputs_of(m)->time_fact, 1);
        mu_text_add(out, "\n");
    }
}

static bool percept_line_load(struct snapshot *c)
{
    struct mu_percept p = {.time_ns = 0};
    uint64_t n[5];
    bool good = snapshot_line(c, "percept");
    for (size_t i = 0; i < 5 && good; i++) {
        good = snapshot_count(c, &n[i]);
    }
    for (size_t i = 0; i < MU_READING_COUNT && good; i++) {
        good = mu_readings[i].type != MU_FIELD_double || field_load(c, &mu_readings[i], (char *)&p);
    }
    if (!good || n[0] >= PERCEPT_BODIES || !snapshot_end(c)) {
        return false;
    }
    inputs_of(c->mind)->body = (enum percept_body)n[0];
    p.time_ns = n[1];
    p.stalled = n[2] != 0;
    p.bumpers = (uint32_t)n[3];
    p.gripper = (uint32_t)n[4];
    inputs_of(c->mind)->percept = p;
    return true;
}

static bool percept_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    uint64_t unseen;
    if (!percept_line_load(c) || !lists_load(c) || !snapshot_line(c, "percept-facts") ||
        !snapshot_count(c, &unseen) || !snapshot_whole(c, &inputs_of(m)->ring_number)) {
        return false;
    }
    inputs_of(m)->ring_unseen = unseen != 0;
    bool good = fact_load(c, &inputs_of(m)->position_fact);
    for (size_t i = 0; i < MU_CHANNEL_COUNT && good && snapshot_more(c); i++) {
        good = facts_load(c, inputs_of(m)->lists[i].facts, percept_fact_count(m, i));
    }
    good = good && snapshot_end(c);
    if (!good || !snapshot_line(c, "time-fact")) {
        return good;
    }
    return fact_load(c, &inputs_of(m)->time_fact) && snapshot_end(c);
}

/* --- mail ------------------------------------------------------------------------------------- */

static void mail_save(struct mind *m, struct mu_text *out)
{
    const struct messages *all = inputs_of(m)->messages;
    for (uint16_t i = all->oldest; i; i = all->at[i].newer) {
        const struct message *e = &all->at[i];
        mu_text_format(out, "message %lld %llu %llu", snapshot_index(m, e->fact),
                       (unsigned long long)e->id, (unsigned long long)e->step);
        snapshot_add_word(out, ValueToString(e->from));
        if (e->first) {
            (void)snapshot_add(out, e->first_type, e->first);
        }
        mu_text_add(out, "\n");
    }
    for (size_t i = 0; i < inputs_of(m)->mail_count; i++) {
        if (EnvFactExistp(m->env, inputs_of(m)->mails[i])) {
            mu_text_format(out, "mail %lld\n", inputs_of(m)->mails[i]->factIndex);
        }
    }
    const struct mail_ring *p = inputs_of(m)->mail_ring;
    for (uint32_t i = 0; i < p->count; i++) {
        const struct mail_ring_entry *mail = &p->mails[(p->first + i) % MAIL_RING_MAX];
        mu_text_format(out, "parked %llu %d", (unsigned long long)mail->id, mail->clips);
        snapshot_add_word(out, ValueToString(mail->from));
        snapshot_add_word(out, p->bytes + mail->at);
        mu_text_add(out, "\n");
    }
}

static bool message_load(struct snapshot *c)
{
    struct message e = {.first_type = SYMBOL};
    struct field first = {.value = NULL};
    if (!fact_load(c, &e.fact) || !snapshot_count(c, &e.id) || !snapshot_count(c, &e.step) ||
        !snapshot_word(c)) {
        return false;
    }
    e.from = EnvAddSymbol(c->mind->env, c->word);
    if (snapshot_more(c)) {
        if (!snapshot_field(c, &first)) {
            return false;
        }
        e.first_type = first.type;
        e.first = first.value;
    }
    return messages_enter(c->mind, &e) && snapshot_end(c);
}

static bool mail_fact_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    struct fact *f;
    if (inputs_of(m)->mail_count == MAILBOX_MAX || !fact_load(c, &f) || !f) {
        return false;
    }
    inputs_of(m)->mails[inputs_of(m)->mail_count++] = f;
    return snapshot_end(c);
}

static bool mail_ring_load(struct snapshot *c)
{
    struct mind_mail mail = {.id = 0};
    struct field content;
    uint64_t clips;
    if (!snapshot_count(c, &mail.id) || !snapshot_count(c, &clips) || !snapshot_word(c) ||
        !snapshot_field(c, &content) || content.type != SYMBOL) {
        return false;
    }
    mail.src = c->word;
    mail.content = ValueToString(content.value);
    return mail_ring_put(c->mind, &mail, clips != 0) == MU_OK && snapshot_end(c);
}

static bool mail_load(struct snapshot *c)
{
    bool good = true;
    while (good && snapshot_line(c, "message")) {
        good = message_load(c);
    }
    while (good && snapshot_line(c, "mail")) {
        good = mail_fact_load(c);
    }
    while (good && snapshot_line(c, "parked")) {
        good = mail_ring_load(c);
    }
    return good;
}

/* --- what else there is ----------------------------------------------------------------------- */

static void life_save(struct mind *m, struct mu_text *out)
{
    mu_text_add(out, "events");
    for (size_t i = 0; i < MU_EVENTS; i++) {
        mu_text_format(out, " %d", inputs_of(m)->pending[i]);
    }
    facts_save(m, out, inputs_of(m)->events, MU_EVENTS);
    mu_text_format(out, "\nrefused %zu", inputs_of(m)->refused_next);
    facts_save(m, out, inputs_of(m)->refused, EVENTS_REFUSED_MAX);
    mu_text_add(out, "\n");
    for (size_t i = 0; i < output_of(m)->handler_count; i++) {
        mu_text_format(out, "handler %u", output_of(m)->handlers[i].layer);
        snapshot_add_word(out, ValueToString(output_of(m)->handlers[i].function));
        mu_text_add(out, "\n");
    }
    if (output_of(m)->resolver) {
        mu_text_add(out, "resolver");
        snapshot_add_word(out, output_of(m)->scheme);
        snapshot_add_word(out, ValueToString(output_of(m)->resolver));
        mu_text_add(out, "\n");
    }
}

static bool handler_load(struct snapshot *c)
{
    uint64_t layer;
    return snapshot_count(c, &layer) && layer <= UINT32_MAX && snapshot_word(c) &&
           layers_add(c->mind, (uint32_t)layer, c->word) == MU_OK && snapshot_end(c);
}

static bool resolver_load(struct snapshot *c)
{
    char scheme[MU_NAME_MAX + 1];
    return snapshot_word(c) && mu_text_copy(scheme, sizeof scheme, c->word) && snapshot_word(c) &&
           layers_set_resolver(c->mind, scheme, c->word) == MU_OK && snapshot_end(c);
}

static bool life_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    uint64_t number;
    bool good = snapshot_line(c, "events");
    for (size_t i = 0; i < MU_EVENTS && good; i++) {
        good = snapshot_count(c, &number);
        inputs_of(m)->pending[i] = good && number != 0;
    }
    good = good && facts_load(c, inputs_of(m)->events, MU_EVENTS) && snapshot_end(c) &&
           snapshot_line(c, "refused") && snapshot_count(c, &number);
    inputs_of(m)->refused_next = good ? number % EVENTS_REFUSED_MAX : 0;
    good = good && facts_load(c, inputs_of(m)->refused, EVENTS_REFUSED_MAX) && snapshot_end(c);
    while (good && snapshot_line(c, "handler")) {
        good = handler_load(c);
    }
    if (good && snapshot_line(c, "resolver")) {
        good = resolver_load(c);
    }
    return good;
}

enum { STATE_NUMBERS = 7 };

void snapshot_save_state(struct mind *m, struct mu_text *out)
{
    mu_text_format(out, "mind %llu %llu %llu %u %d %d %u\n",
                   (unsigned long long)output_of(m)->random.state,
                   (unsigned long long)output_of(m)->asked, (unsigned long long)inputs_of(m)->step,
                   inputs_of(m)->senses_named, inputs_of(m)->rules_getmsg, (int)output_of(m)->wish,
                   output_of(m)->wish_rules);
    percept_save(m, out);
    mail_save(m, out);
    life_save(m, out);
    snapshot_save_watch(m, out);
    mu_text_add(out, "end\n");
}

mu_result snapshot_load_state(struct snapshot *c)
{
    struct mind *m = c->mind;
    uint64_t n[STATE_NUMBERS];
    if (!counts_load(c, "mind", n, STATE_NUMBERS) || n[5] > MIND_WISH_SUSPEND) {
        return snapshot_wrong(c, "the numbers of the mind");
    }
    output_of(m)->random.state = n[0];
    output_of(m)->asked = n[1];
    inputs_of(m)->step = n[2];
    inputs_of(m)->senses_named |= (uint32_t)n[3];
    inputs_of(m)->rules_getmsg = inputs_of(m)->rules_getmsg || n[4] != 0;
    output_of(m)->wish = (enum mind_wish)n[5];
    output_of(m)->wish_rules = (uint32_t)n[6];
    if (!percept_load(c)) {
        return snapshot_wrong(c, "what the mind has sensed");
    }
    if (!mail_load(c)) {
        return snapshot_wrong(c, "mail");
    }
    if (!life_load(c)) {
        return snapshot_wrong(c, "events and handlers");
    }
    MU_TRY(snapshot_load_watch(c));
    return snapshot_line(c, "end") ? MU_OK : snapshot_wrong(c, "the end");
}
