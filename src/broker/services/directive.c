/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/services.h"

#include "broker/control/parts.h"
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

/* The one line that the broker carries out; so does its part that delivers. */
static const char INTERVAL[] = "delivery-interval";

enum { VALUE_MAX = 255 };

static const char *space_skip(const char *c)
{
    return c + strspn(c, " \t\r\n");
}

/* Takes "(delivery-interval VALUE)" apart.  @return false: it is another line */
static bool line_read(const char *line, char value[VALUE_MAX + 1])
{
    const char *c = space_skip(line);
    c = *c == '(' ? space_skip(c + 1) : "";
    size_t len = strcspn(c, " \t\r\n)");
    bool is_known = len == sizeof INTERVAL - 1 && memcmp(INTERVAL, c, len) == 0;
    c = space_skip(c + len);
    const char *close = strrchr(c, ')');
    if (!is_known || !close || *space_skip(close + 1) != '\0') {
        return false;
    }
    while (close > c && strchr(" \t\r\n", close[-1])) {
        close--;
    }
    bool fits = (size_t)(close - c) <= VALUE_MAX;
    memcpy(value, c, fits ? (size_t)(close - c) : 0); /* what is too long is no value */
    value[fits ? close - c : 0] = '\0';
    return true;
}

/* @return the performative of the answer */
static const char *line_take(struct broker *b, uint32_t own, const char *line, struct mu_text *t)
{
    char value[VALUE_MAX + 1];
    double ms;
    if ((own != REGISTRY_BROKER && own != PART_DELIVERY) || !line_read(line, value)) {
        mu_text_format(t, "\"the broker carries out: (%s MS)\"", INTERVAL);
        return "failure";
    }
    if (!number_read(value, 0, DISPATCH_INTERVAL_MAX_MS, &ms)) {
        mu_text_format(t, "\"%s: expected milliseconds, from 0 (at once) to %d\"", INTERVAL,
                       DISPATCH_INTERVAL_MAX_MS);
        return "failure";
    }
    dispatch_set_interval(b, (uint64_t)(ms * 1e6));
    mu_text_format(t, "%s %g", INTERVAL, ms);
    return "inform";
}

void directive_take(struct broker *b, uint32_t own, const struct mail *m)
{
    char content[1024];
    struct mu_text t = mu_text_in(content, sizeof content);
    if (strcmp(m->letter.performative, "do") != 0) {
        mu_text_format(&t, "%s %s", m->letter.performative,
                       mu_refusal_word(MU_REFUSAL_UNSUPPORTED));
        answer_reply(b, own, m, "refuse", content);
        return;
    }
    const char *performative = line_take(b, own, m->letter.content, &t);
    answer_reply(b, own, m, performative, content);
}
