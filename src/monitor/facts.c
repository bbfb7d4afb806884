/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/facts.h"

#include "core/log.h"
#include "mind/syntax/syntax.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

const char *const facts_of_a_step[] = {"step",  "robot",     "agent", "team",
                                       "thing", "mail-seen", "fired", NULL};

static const double MM = 1000;
static const double DEG = 180 / M_PI;

/* --- fields ----------------------------------------------------------------------------------- */

static void quoted_add(struct mu_text *t, const char *text)
{
    mu_text_add(t, "\"");
    for (; *text; text++) {
        mu_text_add(t, *text == '"' || *text == '\\' ? "\\" : "");
        mu_text_add_bytes(t, text, 1);
    }
    mu_text_add(t, "\"");
}

/* Bytes that begin a variable or a wildcard in a fact. */
static bool field_is_plain(const struct syntax_field *f)
{
    return f->kind != SYNTAX_FIELD_BAD &&
           (f->kind != SYNTAX_FIELD_SYMBOL || !strchr("?$=:~&|", f->at[0]));
}

void facts_add_word(struct mu_text *t, const char *word)
{
    const char *at = word;
    struct syntax_field f = syntax_read_field(&at);
    bool symbol = f.kind == SYNTAX_FIELD_SYMBOL && f.len == strlen(word) && field_is_plain(&f);
    if (symbol) {
        mu_text_add(t, word);
    } else if (word[0] == '\0') {
        mu_text_add(t, "nil");
    } else {
        quoted_add(t, word);
    }
}

void facts_add_content(struct mu_text *t, const char *language, const char *content)
{
    bool list = language[0] == '\0' || strcmp(language, "clips") == 0;
    struct syntax_field f;
    const char *at = content;
    while (list && (f = syntax_read_field(&at)).kind != SYNTAX_FIELD_END) {
        list = field_is_plain(&f);
    }
    if (list) {
        mu_text_add(t, content);
    } else {
        quoted_add(t, content);
    }
}

static void slot_real(struct mu_text *t, const char *slot, double value)
{
    mu_text_format(t, " (%s %.17g%s)", slot, value,
                   value == floor(value) && fabs(value) < 1e15 ? ".0" : "");
}

static void slot_word(struct mu_text *t, const char *slot, const char *word)
{
    mu_text_format(t, " (%s ", slot);
    facts_add_word(t, word);
    mu_text_add(t, ")");
}

static void slot_truth(struct mu_text *t, const char *slot, bool value)
{
    mu_text_format(t, " (%s %s)", slot, value ? "TRUE" : "FALSE");
}

/* As rules have headings: in (-180, 180]. */
static double degrees(double rad)
{
    double deg = remainder(rad * DEG, 360);
    return deg <= -180 ? deg + 360 : deg;
}

/* --- facts ------------------------------------------------------------------------------------ */

/* Writes a word that is no symbol as a string, as (text) does. */
static struct mind_slot word(const char *slot, const char *text)
{
    const char *at = text;
    struct syntax_field f = syntax_read_field(&at);
    bool symbol = f.kind == SYNTAX_FIELD_SYMBOL && f.len == strlen(text) && field_is_plain(&f);
    return (struct mind_slot){.name = slot,
                              .kind = symbol || !text[0] ? MIND_SLOT_SYMBOL : MIND_SLOT_STRING,
                              .word = text[0] ? text : "nil"};
}

static struct mind_slot real(const char *slot, double value)
{
    return (struct mind_slot){.name = slot, .kind = MIND_SLOT_REAL, .real = value};
}

static struct mind_slot count(const char *slot, uint64_t value)
{
    return (struct mind_slot){.name = slot, .kind = MIND_SLOT_COUNT, .count = value};
}

static struct mind_slot truth(const char *slot, bool value)
{
    return word(slot, value ? "TRUE" : "FALSE");
}

static void slots_tell(struct mind *m, const char *relation, const struct mind_slot *slots,
                       size_t slots_count)
{
    if (mind_tell_slots(m, relation, slots, slots_count) != MU_OK) {
        mu_log(MU_LOG_INFO, "fact-refused", "fact=%s", relation);
    }
}

static void robot_tell(struct mind *m, const mu_stats *s, size_t robot,
                       const struct mu_robot_view *v)
{
    const struct mu_stats_robot *r = mu_stats_robot(s, robot);
    bool near = r->nearest_m >= 0;
    const struct mind_slot slots[] = {
        word("name", v->name),
        word("state", mu_state_text(v->state)),
        real("x", v->x_m * MM),
        real("y", v->y_m * MM),
        real("heading", degrees(v->heading_rad)),
        real("speed", v->forward_m_s * MM),
        real("turn-rate", v->turn_rad_s * DEG),
        real("command-speed", v->command_forward_m_s * MM),
        real("command-turn-rate", v->command_turn_rad_s * DEG),
        truth("stalled", v->stalled),
        real("distance", r->distance_m * MM),
        count("stalls", r->stalls),
        real("stalled-time", r->stalled_s),
        real("mean-speed", r->mean_speed_m_s * MM),
        real("efficiency", r->efficiency_m_s * MM),
        count("sent", r->mails_sent),
        count("received", r->mails_received),
        count("fired", r->firings),
        real("explored", r->explored),
        word("nearest", near ? mu_stats_robot(s, r->nearest)->name : "nil"),
        real("nearest-distance", near ? r->nearest_m * MM : -1),
        real("nearest-time", near ? r->nearest_s : -1),
        real("goal-time", r->goal_s),
        truth("at-goal", r->there),
    };
    size_t all = sizeof slots / sizeof slots[0];
    slots_tell(m, "robot", slots, r->has_goal ? all : all - 2);
}

static void agent_tell(struct mind *m, const struct mu_stats_agent *a)
{
    const struct mind_slot slots[] = {
        word("name", a->name),        word("state", mu_state_text(a->state)),
        count("sent", a->mails_sent), count("received", a->mails_received),
        count("fired", a->firings),
    };
    slots_tell(m, "agent", slots, sizeof slots / sizeof slots[0]);
}

static void team_tell(struct mind *m, const mu_stats *s)
{
    struct mu_stats_team team = mu_stats_team(s);
    const struct mind_slot slots[] = {
        real("distance", team.distance_m * MM),
        count("stalls", team.stalls),
        real("explored", team.explored),
        word("most-efficient", team.most_efficient ? team.most_efficient : "nil"),
        count("sent", team.mails_sent),
        count("received", team.mails_received),
        count("fired", team.firings),
    };
    slots_tell(m, "team", slots, sizeof slots / sizeof slots[0]);
}

static void object_tell(struct mind *m, const struct mu_object_view *o)
{
    const struct mind_slot slots[] = {word("name", o->name), real("x", o->x_m * MM),
                                      real("y", o->y_m * MM),
                                      real("heading", degrees(o->heading_rad))};
    slots_tell(m, "thing", slots, sizeof slots / sizeof slots[0]);
}

/* Writes (mail-seen ...). */
static void facts_write_mail(struct mu_text *t, const struct mu_mail *mail, bool outside)
{
    mu_text_clear(t);
    mu_text_add(t, "(mail-seen");
    slot_word(t, "from", mail->src);
    slot_word(t, "to", mail->dst);
    slot_word(t, "performative", mail->performative);
    slot_word(t, "language", mail->language);
    slot_word(t, "conversation",
              mail->conversation && mail->conversation[0] ? mail->conversation : "nil");
    slot_truth(t, "outside", outside);
    mu_text_add(t, " (content ");
    facts_add_content(t, mail->language, mail->content);
    mu_text_add(t, "))");
}

void facts_write_end(struct mu_text *t, const struct mu_run_result *result)
{
    static const char *const ends[] = {
        [MU_RUN_DONE] = "done", [MU_RUN_FAULT] = "fault", [MU_RUN_LOST] = "lost"};
    mu_text_clear(t);
    mu_text_format(t, "(run-ended (how %s) (step %" PRId64 ")", ends[result->end], result->step);
    slot_real(t, "time", (double)result->time_ns / 1e9);
    mu_text_add(t, " (hash ");
    quoted_add(t, result->hash);
    mu_text_add(t, "))");
}

/* --- a step ----------------------------------------------------------------------------------- */

/* Two equal facts are one: a mail that was sent twice in a step, or a rule that fired twice. */
static void tell(struct mind *m, const struct mu_text *fact)
{
    if (fact->cut || mind_tell(m, fact->at) != MU_OK) {
        mu_log(MU_LOG_INFO, "fact-refused", "fact=%.200s", fact->at);
    }
}

static void fired_tell(struct mind *m, struct mu_text *t, const struct mu_act_view *act)
{
    for (const char *rule = act->rules; *rule; rule += strspn(rule, " ")) {
        char name[MU_ATTRIBUTES_MAX + 1];
        size_t len = strcspn(rule, " ");
        snprintf(name, sizeof name, "%.*s", (int)(len < sizeof name ? len : sizeof name - 1), rule);
        mu_text_clear(t);
        mu_text_add(t, "(fired ");
        facts_add_word(t, act->agent);
        mu_text_add(t, " ");
        facts_add_word(t, name);
        mu_text_add(t, ")");
        tell(m, t);
        rule += len;
    }
}

static void mails_tell(struct mind *m, struct mu_text *t, const struct mu_mail *mails, size_t count,
                       bool outside)
{
    for (size_t i = 0; i < count; i++) {
        facts_write_mail(t, &mails[i], outside);
        tell(m, t);
    }
}

/* Facts that no rule looks at cost more than all others. */
static void acts_tell(struct mind *m, struct mu_text *t, const struct mu_frame *f)
{
    bool mails = mind_looks_at(m, "mail-seen"), fired = mind_looks_at(m, "fired");
    for (size_t i = 0; i < f->act_count; i++) {
        if (mails) {
            mails_tell(m, t, f->acts[i].mails, f->acts[i].mail_count, false);
        }
        if (fired) {
            fired_tell(m, t, &f->acts[i]);
        }
    }
    if (mails) {
        mails_tell(m, t, f->outside, f->outside_count, true);
    }
}

void facts_tell(struct mind *m, const mu_stats *s, const struct mu_frame *f)
{
    static char bytes[FACTS_TEXT];
    struct mu_text t = mu_text_in(bytes, sizeof bytes);
    for (size_t i = 0; i < f->robot_count && i < mu_stats_count(s); i++) {
        robot_tell(m, s, i, &f->robots[i]);
    }
    for (size_t i = 0; i < mu_stats_agent_count(s); i++) {
        agent_tell(m, mu_stats_agent(s, i));
    }
    team_tell(m, s);
    for (size_t i = 0; i < f->object_count; i++) {
        object_tell(m, &f->objects[i]);
    }
    acts_tell(m, &t, f);
}
