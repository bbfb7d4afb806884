/* SPDX-License-Identifier: Apache-2.0 */
/* What goes on in a mind, line by line, for recordings: docs/reference/frame.md has the lines. */
#include "mind/engine/engine.h"

#include <math.h>
#include <string.h>

enum { TRACE_TAIL = 32 }; /* bytes for the word that lines were lost */

/* --- lines ------------------------------------------------------------------------------------ */

/* A line that does not fit is left out whole, and counted. */
static void line_end(struct mind *m, size_t start)
{
    mu_text_add(&m->trace, "\n");
    if (m->trace.cut) {
        m->trace.len = start;
        m->trace.at[start] = '\0';
        m->trace.cut = false;
        m->trace_lost++;
    }
}

/* Text of strangers: it stays in its line. */
static void line_add(struct mu_text *out, const char *s)
{
    size_t len = strlen(s);
    if (!memchr(s, '\n', len) && !memchr(s, '\r', len)) {
        mu_text_add_bytes(out, s, len);
        return;
    }
    for (; *s; s++) {
        if (*s == '\n' || *s == '\r') {
            mu_text_add(out, *s == '\n' ? "\\n" : "\\r");
        } else {
            mu_text_add_bytes(out, s, 1);
        }
    }
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
    struct mu_text *out = &m->trace;
    if (f->type == FLOAT && m->trace_fact != TRACE_CAUSED) {
        line_add_reading(out, ValueToDouble(f->value));
        return;
    }
    mu_text_add(out, " ");
    if (f->type == FLOAT) {
        syntax_add_float(out, ValueToDouble(f->value));
    } else if (f->type == INTEGER) {
        mu_text_add_number(out, ValueToLong(f->value));
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
    mu_text_add(&m->trace, "(");
    mu_text_add(&m->trace, ValueToString(t->header.name));
    if (t->implied) {
        line_add_slot(m, value);
    }
    for (const struct templateSlot *s = t->implied ? NULL : t->slotList; s; s = s->next) {
        mu_text_add(&m->trace, " (");
        mu_text_add(&m->trace, ValueToString(s->slotName));
        line_add_slot(m, value++);
        mu_text_add(&m->trace, ")");
    }
    mu_text_add(&m->trace, ")");
}

/* What patterns have matched. */
static void line_add_basis(struct mu_text *out, const struct partialMatch *basis)
{
    for (unsigned i = 0; basis && i < basis->bcount; i++) {
        mu_text_add(out, i > 0 ? "," : " ");
        value_add_match(out, basis->binds[i].gm.theMatch);
    }
}

/* --- what CLIPS tells of ---------------------------------------------------------------------- */

static void trace_asserted(void *env, void *fact)
{
    struct mind *m = environment_mind(env);
    size_t start = m->trace.len;
    mu_text_add(&m->trace, m->trace_fact == TRACE_SHOWN ? "=" : "+");
    mu_text_add_number(&m->trace, ((const struct fact *)fact)->factIndex);
    mu_text_add(&m->trace, " ");
    line_add_fact(m, fact);
    line_end(m, start);
}

static void trace_retracted(void *env, void *fact)
{
    struct mind *m = environment_mind(env);
    size_t start = m->trace.len;
    mu_text_add(&m->trace, "-");
    mu_text_add_number(&m->trace, ((const struct fact *)fact)->factIndex);
    line_end(m, start);
}

void trace_install(struct mind *m)
{
    size_t size = m->options.trace ? sizeof m->trace_bytes - TRACE_TAIL : 1;
    mu_text_init(&m->trace, m->trace_bytes, size);
    if (m->options.trace) {
        EnvAddAssertFunction(m->env, "mu-trace", trace_asserted, 0);
        EnvAddRetractFunction(m->env, "mu-trace", trace_retracted, 0);
        mu_text_add(&m->trace, "0\n");
    }
}

/* --- what the mind tells of ------------------------------------------------------------------- */

void trace_cause(struct mind *m, char kind, const char *what, const char *text)
{
    if (m->options.trace) {
        size_t start = m->trace.len;
        mu_text_add_bytes(&m->trace, &kind, 1);
        mu_text_add(&m->trace, what[0] ? " " : "");
        mu_text_add(&m->trace, what);
        mu_text_add(&m->trace, text[0] ? " " : "");
        line_add(&m->trace, text);
        line_end(m, start);
    }
}

void trace_line(struct mind *m, struct syntax_form form)
{
    char text[TRACE_LINE];
    snprintf(text, sizeof text, "%.*s", (int)form.len, form.at);
    trace_cause(m, 'L', "", text);
}

void trace_mail(struct mind *m, const struct mind_mail *mail)
{
    if (m->options.trace) {
        size_t start = m->trace.len;
        mu_text_add(&m->trace, "M ");
        mu_text_add(&m->trace, mail->src);
        mu_text_add(&m->trace, " ");
        mu_text_add_number(&m->trace, (long long)mail->id);
        mu_text_add(&m->trace, " ");
        mu_text_add(&m->trace, mail->performative[0] ? mail->performative : "-");
        mu_text_add(&m->trace, " ");
        line_add(&m->trace, mail->content);
        line_end(m, start);
    }
}

void trace_rule(struct mind *m)
{
    if (m->options.trace) {
        size_t start = m->trace.len;
        mu_text_add(&m->trace, "R ");
        mu_text_add(&m->trace, m->rule);
        line_add_basis(&m->trace, EngineData(m->env)->GlobalLHSBinds);
        line_end(m, start);
    }
}

void trace_speed(struct mind *m, double forward_m_s, double turn_rad_s)
{
    if (m->options.trace) {
        size_t start = m->trace.len;
        mu_text_add(&m->trace, "V");
        line_add_reading(&m->trace, forward_m_s * 1000);
        line_add_reading(&m->trace, turn_rad_s * 180 / M_PI);
        line_end(m, start);
    }
}

void trace_told(struct mind *m, const struct mind_letter *letter)
{
    if (m->options.trace) {
        size_t start = m->trace.len;
        mu_text_add(&m->trace, "T ");
        mu_text_add(&m->trace, letter->dst);
        mu_text_add(&m->trace, " ");
        mu_text_add(&m->trace, letter->performative[0] ? letter->performative : "-");
        mu_text_add(&m->trace, " ");
        line_add(&m->trace, letter->content);
        line_end(m, start);
    }
}

/* What could fire next, of the module that is in focus. */
void trace_agenda(struct mind *m)
{
    size_t left = m->options.trace ? TRACE_AGENDA : 0;
    for (struct activation *a = left > 0 ? EnvGetNextActivation(m->env, NULL) : NULL; a && left > 0;
         a = EnvGetNextActivation(m->env, a), left--) {
        size_t start = m->trace.len;
        mu_text_add(&m->trace, "A ");
        mu_text_add(&m->trace, ValueToString(a->theRule->header.name));
        line_add_basis(&m->trace, a->basis);
        line_end(m, start);
    }
}
