/* SPDX-License-Identifier: Apache-2.0 */
/* What C code keeps of a mind: percept, mail, handlers, events, random numbers. */
#include "mind/facts/facts.h"
#include "mind/snapshot/snapshot.h"

#include <string.h>

/* --- numbers ---------------------------------------------------------------------------------- */

static bool reals_load(struct snapshot *c, double **reals, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!snapshot_real(c, reals[i])) {
            return false;
        }
    }
    return true;
}

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
    if (!snapshot_line(c, word) || !snapshot_count(c, &wanted) || wanted > most) {
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

/* A fact that C code keeps, or has let rules take away. */
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

static void percept_save(struct mind *m, struct mu_text *out)
{
    struct mu_percept *p = &m->percept;
    double *reals[PERCEPT_REALS];
    percept_reals(p, reals);
    mu_text_format(out, "percept %d %llu %d %u %u", m->sensed, (unsigned long long)p->time_ns,
                   p->stalled, p->bumpers, p->gripper);
    for (size_t i = 0; i < PERCEPT_REALS; i++) {
        snapshot_add_real(out, *reals[i]);
    }
    mu_text_add(out, "\n");
    floats_save(out, "sonar", m->sonar, p->sonar_count);
    floats_save(out, "laser", m->laser_m, p->laser_count);
    for (size_t i = 0; i < p->blob_count; i++) {
        const struct mu_blob *b = &m->blobs[i];
        mu_text_format(out, "blob %u %a %a %a\n", b->rgb, b->bearing_rad, b->width_rad, b->range_m);
    }
    for (size_t i = 0; i < p->fiducial_count; i++) {
        const struct mu_fiducial *f = &m->fiducials[i];
        mu_text_format(out, "fiducial %d %a %a %a\n", f->number, f->bearing_rad, f->range_m,
                       f->heading_rad);
    }
    mu_text_format(out, "percept-facts %d %lld", m->ring_unseen, m->ring_number);
    struct fact *const facts[] = {m->position_fact, m->ring_fact, m->laser_fact};
    facts_save(m, out, facts, 3);
    facts_save(m, out, m->blob_facts, p->blob_count);
    facts_save(m, out, m->fiducial_facts, p->fiducial_count);
    mu_text_add(out, "\n");
}

static bool percept_line_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    struct mu_percept p = {.time_ns = 0};
    double *reals[PERCEPT_REALS];
    uint64_t n[5];
    percept_reals(&p, reals);
    bool good = snapshot_line(c, "percept");
    for (size_t i = 0; i < 5 && good; i++) {
        good = snapshot_count(c, &n[i]);
    }
    if (!good || !reals_load(c, reals, PERCEPT_REALS) || !snapshot_end(c)) {
        return false;
    }
    m->sensed = n[0] != 0;
    p.time_ns = n[1];
    p.stalled = n[2] != 0;
    p.bumpers = (uint32_t)n[3];
    p.gripper = (uint32_t)n[4];
    p.sonar_m = m->sonar;
    p.laser_m = m->laser_m;
    p.blobs = m->blobs;
    p.fiducials = m->fiducials;
    m->percept = p;
    return true;
}

static bool blobs_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    size_t *count = &m->percept.blob_count;
    while (snapshot_line(c, "blob")) {
        uint64_t rgb;
        struct mu_blob b = {0};
        double *reals[] = {&b.bearing_rad, &b.width_rad, &b.range_m};
        if (*count == MU_BLOBS_MAX || !snapshot_count(c, &rgb) || !reals_load(c, reals, 3) ||
            !snapshot_end(c)) {
            return false;
        }
        b.rgb = (uint32_t)rgb;
        m->blobs[(*count)++] = b;
    }
    return true;
}

static bool fiducials_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    size_t *count = &m->percept.fiducial_count;
    while (snapshot_line(c, "fiducial")) {
        long long number;
        struct mu_fiducial f = {0};
        double *reals[] = {&f.bearing_rad, &f.range_m, &f.heading_rad};
        if (*count == MU_FIDUCIALS_MAX || !snapshot_whole(c, &number) || !reals_load(c, reals, 3) ||
            !snapshot_end(c)) {
            return false;
        }
        f.number = (int32_t)number;
        m->fiducials[(*count)++] = f;
    }
    return true;
}

static bool percept_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    uint64_t unseen;
    if (!percept_line_load(c) ||
        !floats_load(c, "sonar", m->sonar, &m->percept.sonar_count, MU_SONARS_MAX) ||
        !floats_load(c, "laser", m->laser_m, &m->percept.laser_count, MU_BEAMS_MAX) ||
        !blobs_load(c) || !fiducials_load(c) || !snapshot_line(c, "percept-facts") ||
        !snapshot_count(c, &unseen) || !snapshot_whole(c, &m->ring_number)) {
        return false;
    }
    m->ring_unseen = unseen != 0;
    return fact_load(c, &m->position_fact) && fact_load(c, &m->ring_fact) &&
           fact_load(c, &m->laser_fact) && facts_load(c, m->blob_facts, m->percept.blob_count) &&
           facts_load(c, m->fiducial_facts, m->percept.fiducial_count) && snapshot_end(c);
}

/* --- mail ------------------------------------------------------------------------------------- */

static void mail_save(struct mind *m, struct mu_text *out)
{
    const struct messages *all = m->messages;
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
    for (size_t i = 0; i < m->mail_count; i++) {
        if (EnvFactExistp(m->env, m->mails[i])) {
            mu_text_format(out, "mail %lld\n", m->mails[i]->factIndex);
        }
    }
    const struct mail_ring *p = m->parked;
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
    if (m->mail_count == MAILBOX_MAX || !fact_load(c, &f) || !f) {
        return false;
    }
    m->mails[m->mail_count++] = f;
    return snapshot_end(c);
}

static bool parked_load(struct snapshot *c)
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
        good = parked_load(c);
    }
    return good;
}

/* --- what else there is ----------------------------------------------------------------------- */

static void life_save(struct mind *m, struct mu_text *out)
{
    mu_text_add(out, "events");
    for (size_t i = 0; i < MU_EVENTS; i++) {
        mu_text_format(out, " %d", m->pending[i]);
    }
    facts_save(m, out, m->events, MU_EVENTS);
    mu_text_format(out, "\nrefused %zu", m->refused_next);
    facts_save(m, out, m->refused, EVENTS_REFUSED_MAX);
    mu_text_add(out, "\n");
    for (size_t i = 0; i < m->handler_count; i++) {
        mu_text_format(out, "handler %u", m->handlers[i].layer);
        snapshot_add_word(out, ValueToString(m->handlers[i].function));
        mu_text_add(out, "\n");
    }
}

static bool handler_load(struct snapshot *c)
{
    uint64_t layer;
    return snapshot_count(c, &layer) && layer <= UINT32_MAX && snapshot_word(c) &&
           layers_add(c->mind, (uint32_t)layer, c->word) == MU_OK && snapshot_end(c);
}

static bool life_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    uint64_t number;
    bool good = snapshot_line(c, "events");
    for (size_t i = 0; i < MU_EVENTS && good; i++) {
        good = snapshot_count(c, &number);
        m->pending[i] = good && number != 0;
    }
    good = good && facts_load(c, m->events, MU_EVENTS) && snapshot_end(c) &&
           snapshot_line(c, "refused") && snapshot_count(c, &number);
    m->refused_next = good ? number % EVENTS_REFUSED_MAX : 0;
    good = good && facts_load(c, m->refused, EVENTS_REFUSED_MAX) && snapshot_end(c);
    while (good && snapshot_line(c, "handler")) {
        good = handler_load(c);
    }
    return good;
}

enum { STATE_NUMBERS = 7 };

void snapshot_save_state(struct mind *m, struct mu_text *out)
{
    mu_text_format(out, "mind %llu %llu %llu %u %d %d %u\n", (unsigned long long)m->random.state,
                   (unsigned long long)m->asked, (unsigned long long)m->step, m->senses_named,
                   m->rules_getmsg, (int)m->wish, m->wish_rules);
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
    m->random.state = n[0];
    m->asked = n[1];
    m->step = n[2];
    m->senses_named |= (uint32_t)n[3];
    m->rules_getmsg = m->rules_getmsg || n[4] != 0;
    m->wish = (enum mind_wish)n[5];
    m->wish_rules = (uint32_t)n[6];
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
