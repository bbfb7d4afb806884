/* SPDX-License-Identifier: Apache-2.0 */
/* What goes on in a mind, line by line, for recordings: docs/observing.md has the lines. */
#include "mind/engine/engine.h"

#include <math.h>
#include <string.h>

enum { DIARY_TAIL = 32 }; /* bytes for the word that lines were lost */

/* --- lines ------------------------------------------------------------------------------------ */

/* A line that does not fit is left out whole, and counted. */
static void line_end(struct mind *m, size_t start)
{
    mu_text_add(&m->diary, "\n");
    if (m->diary.cut) {
        m->diary.len = start;
        m->diary.at[start] = '\0';
        m->diary.cut = false;
        m->diary_lost++;
    }
}

/* Text of strangers: it stays in its line. */
static void line_add(struct mu_text *out, const char *s)
{
    for (size_t len = strcspn(s, "\n\r"); s[len]; len = strcspn(s, "\n\r")) {
        mu_text_add_bytes(out, s, len);
        mu_text_add(out, s[len] == '\n' ? "\\n" : "\\r");
        s += len + 1;
    }
    mu_text_add(out, s);
}

/* Thousandths are more than a percept means, and take a tenth of the time of 17 digits. */
static void line_add_reading(struct mu_text *out, double x)
{
    char digits[32];
    size_t at = sizeof digits;
    if (fabs(x) >= 1e12) {
        mu_text_format(out, " %.17g", x);
        return;
    }
    long long scaled = llround(fabs(x) * 1000);
    int places = 3;
    while (places > 1 && scaled % 10 == 0) {
        scaled /= 10;
        places--;
    }
    bool negative = x < 0 && scaled > 0;
    for (int i = 0; i <= places || scaled > 0; i++) {
        digits[--at] = (char)('0' + scaled % 10);
        scaled /= 10;
        if (i == places - 1) {
            digits[--at] = '.';
        }
    }
    digits[--at] = negative ? '-' : ' ';
    mu_text_add(out, negative ? " " : "");
    mu_text_add_bytes(out, digits + at, sizeof digits - at);
}

static void line_add_field(struct mind *m, const struct field *f)
{
    struct mu_text *out = &m->diary;
    if (f->type == FLOAT && m->diary_fact != CLIPS_DIARY_CAUSED) {
        line_add_reading(out, ValueToDouble(f->value));
        return;
    }
    mu_text_add(out, " ");
    if (f->type == FLOAT) {
        clips_text_add_float(out, ValueToDouble(f->value));
    } else if (f->type == INTEGER) {
        mu_text_format(out, "%lld", ValueToLong(f->value));
    } else if (f->type == STRING) {
        mu_text_add(out, "\"");
        line_add(out, ValueToString(f->value));
        mu_text_add(out, "\"");
    } else if (f->type == SYMBOL || f->type == INSTANCE_NAME) {
        line_add(out, ValueToString(f->value));
    } else {
        mu_text_add(out, "?");
    }
}

static void line_add_slot(struct mind *m, const struct field *value)
{
    if (value->type != MULTIFIELD) {
        line_add_field(m, value);
        return;
    }
    const struct multifield *fields = value->value;
    for (long i = 0; i < fields->multifieldLength; i++) {
        line_add_field(m, &fields->theFields[i]);
    }
}

static void line_add_fact(struct mind *m, const struct fact *f)
{
    const struct deftemplate *t = f->whichDeftemplate;
    const struct field *value = f->theProposition.theFields;
    mu_text_format(&m->diary, "(%s", ValueToString(t->header.name));
    if (t->implied) {
        line_add_slot(m, value);
    }
    for (const struct templateSlot *s = t->implied ? NULL : t->slotList; s; s = s->next) {
        mu_text_format(&m->diary, " (%s", ValueToString(s->slotName));
        line_add_slot(m, value++);
        mu_text_add(&m->diary, ")");
    }
    mu_text_add(&m->diary, ")");
}

/* What patterns have matched. */
static void line_add_basis(struct mu_text *out, const struct partialMatch *basis)
{
    for (unsigned i = 0; basis && i < basis->bcount; i++) {
        mu_text_add(out, i > 0 ? "," : " ");
        clips_value_add_match(out, basis->binds[i].gm.theMatch);
    }
}

/* --- what CLIPS tells of ---------------------------------------------------------------------- */

static void diary_asserted(void *env, void *fact)
{
    struct mind *m = environment_mind(env);
    size_t start = m->diary.len;
    mu_text_format(&m->diary, "%c%lld ", m->diary_fact == CLIPS_DIARY_SHOWN ? '=' : '+',
                   ((const struct fact *)fact)->factIndex);
    line_add_fact(m, fact);
    line_end(m, start);
}

static void diary_retracted(void *env, void *fact)
{
    struct mind *m = environment_mind(env);
    size_t start = m->diary.len;
    mu_text_format(&m->diary, "-%lld", ((const struct fact *)fact)->factIndex);
    line_end(m, start);
}

void clips_diary_install(struct mind *m)
{
    size_t size = m->options.diary ? sizeof m->diary_bytes - DIARY_TAIL : 1;
    mu_text_init(&m->diary, m->diary_bytes, size);
    if (m->options.diary) {
        EnvAddAssertFunction(m->env, "mu-diary", diary_asserted, 0);
        EnvAddRetractFunction(m->env, "mu-diary", diary_retracted, 0);
        mu_text_add(&m->diary, "0\n");
    }
}

/* --- what the mind tells of ------------------------------------------------------------------- */

void clips_diary_cause(struct mind *m, char kind, const char *what, const char *text)
{
    if (m->options.diary) {
        size_t start = m->diary.len;
        mu_text_format(&m->diary, "%c%s%s", kind, what[0] ? " " : "", what);
        mu_text_add(&m->diary, text[0] ? " " : "");
        line_add(&m->diary, text);
        line_end(m, start);
    }
}

void clips_diary_line(struct mind *m, struct clips_form form)
{
    char text[CLIPS_DIARY_LINE];
    snprintf(text, sizeof text, "%.*s", (int)form.len, form.at);
    clips_diary_cause(m, 'L', "", text);
}

void clips_diary_mail(struct mind *m, const struct mind_mail *mail)
{
    if (m->options.diary) {
        size_t start = m->diary.len;
        mu_text_format(&m->diary, "M %s %llu %s ", mail->src, (unsigned long long)mail->id,
                       mail->performative[0] ? mail->performative : "-");
        line_add(&m->diary, mail->content);
        line_end(m, start);
    }
}

void clips_diary_rule(struct mind *m)
{
    if (m->options.diary) {
        size_t start = m->diary.len;
        mu_text_format(&m->diary, "R %s", m->rule);
        line_add_basis(&m->diary, EngineData(m->env)->GlobalLHSBinds);
        line_end(m, start);
    }
}

void clips_diary_speed(struct mind *m, double forward_m_s, double turn_rad_s)
{
    if (m->options.diary) {
        size_t start = m->diary.len;
        mu_text_add(&m->diary, "V");
        line_add_reading(&m->diary, forward_m_s * 1000);
        line_add_reading(&m->diary, turn_rad_s * 180 / M_PI);
        line_end(m, start);
    }
}

void clips_diary_told(struct mind *m, const struct mind_letter *letter)
{
    if (m->options.diary) {
        size_t start = m->diary.len;
        mu_text_format(&m->diary, "T %s %s ", letter->dst,
                       letter->performative[0] ? letter->performative : "-");
        line_add(&m->diary, letter->content);
        line_end(m, start);
    }
}

/* What could fire next, of the module that is in focus. */
void clips_diary_agenda(struct mind *m)
{
    size_t left = m->options.diary ? CLIPS_DIARY_AGENDA : 0;
    for (struct activation *a = left > 0 ? EnvGetNextActivation(m->env, NULL) : NULL; a && left > 0;
         a = EnvGetNextActivation(m->env, a), left--) {
        size_t start = m->diary.len;
        mu_text_format(&m->diary, "A %s", ValueToString(a->theRule->header.name));
        line_add_basis(&m->diary, a->basis);
        line_end(m, start);
    }
}
