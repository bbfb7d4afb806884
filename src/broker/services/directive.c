/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/services.h"

#include "broker/control/parts.h"
#include "core/text.h"
#include "muster/refusal.h"

#include <stdlib.h>
#include <string.h>

/* Reads one number, all of the text.  @return false if it is none, or out of range */
static bool number_read(const char *text, double min, double max, double *out)
{
    char *end;
    *out = strtod(text, &end);
    return end != text && *end == '\0' && *out >= min && *out <= max;
}

static bool do_delivery_interval(struct broker *b, const char *value, struct mu_text *answer)
{
    double ms;
    if (!number_read(value, 0, DISPATCH_INTERVAL_MAX_MS, &ms)) {
        return false;
    }
    dispatch_set_interval(b, (uint64_t)(ms * 1e6));
    mu_text_format(answer, " %g", ms);
    return true;
}

/* A line for everything that the broker can be told. */
static const struct directive {
    enum metrics_part part; /* whose it is; the broker takes all of them */
    const char *word;
    const char *takes;  /* its values, for people */
    const char *expect; /* of them */
    /* Carries it out and adds the values that hold now.  @return false: a wrong value */
    bool (*carry_out)(struct broker *b, const char *value, struct mu_text *answer);
} directives[] = {
    {PART_DELIVERY, "delivery-interval", "MS", "milliseconds, from 0 (at once) to 60000",
     do_delivery_interval},
};

enum { DIRECTIVES = sizeof directives / sizeof directives[0], VALUE_MAX = 255 };

static const char *space_skip(const char *c)
{
    return c + strspn(c, " \t\r\n");
}

/* Takes "(WORD VALUE...)" apart.  @return the line of the table, or NULL */
static const struct directive *line_read(const char *line, char value[VALUE_MAX + 1])
{
    const char *c = space_skip(line);
    if (*c != '(') {
        return NULL;
    }
    c = space_skip(c + 1);
    size_t len = strcspn(c, " \t\r\n)");
    const struct directive *d = NULL;
    for (size_t i = 0; i < DIRECTIVES; i++) {
        bool same = strlen(directives[i].word) == len && memcmp(directives[i].word, c, len) == 0;
        d = same ? &directives[i] : d;
    }
    c = space_skip(c + len);
    const char *close = strrchr(c, ')');
    if (!close || *space_skip(close + 1) != '\0') {
        return NULL;
    }
    while (close > c && strchr(" \t\r\n", close[-1])) {
        close--;
    }
    bool fits = (size_t)(close - c) <= VALUE_MAX;
    memcpy(value, c, fits ? (size_t)(close - c) : 0); /* what is too long is no value */
    value[fits ? close - c : 0] = '\0';
    return d;
}

static void directives_list(struct mu_text *t)
{
    mu_text_add(t, "\"the broker carries out:");
    for (size_t i = 0; i < DIRECTIVES; i++) {
        mu_text_format(t, " (%s %s)", directives[i].word, directives[i].takes);
    }
    mu_text_add(t, "\"");
}

void directive_take(struct broker *b, uint32_t own, const struct mail *m)
{
    char content[1024], value[VALUE_MAX + 1];
    struct mu_text t;
    mu_text_init(&t, content, sizeof content);
    if (strcmp(m->letter.performative, "do") != 0) {
        mu_text_format(&t, "%s %s", m->letter.performative,
                       mu_refusal_word(MU_REFUSAL_UNSUPPORTED));
        answer_reply(b, own, m, "refuse", content);
        return;
    }
    const struct directive *d = line_read(m->letter.content, value);
    if (!d || (own != REGISTRY_BROKER && own != d->part)) {
        directives_list(&t);
        answer_reply(b, own, m, "failure", content);
        return;
    }
    mu_text_add(&t, d->word);
    bool done = d->carry_out(b, value, &t);
    if (!done) {
        mu_text_clear(&t);
        mu_text_format(&t, "\"%s: expected %s\"", d->word, d->expect);
    }
    answer_reply(b, own, m, done ? "inform" : "failure", content);
}
