/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "muster/refusal.h"

#include <stdlib.h>

/* The one line that the broker carries out; so does its part that delivers. */
static const char INTERVAL[] = "delivery-interval";

static const char *space_skip(const char *c)
{
    return c + strspn(c, " \t\r\n");
}

/* @return what stands behind the word in "(delivery-interval VALUE)"; NULL: it is another line */
static const char *value_of(const char *line)
{
    const char *c = space_skip(line);
    c = *c == '(' ? space_skip(c + 1) : "";
    size_t len = strcspn(c, " \t\r\n)");
    bool is_known = len == sizeof INTERVAL - 1 && memcmp(INTERVAL, c, len) == 0;
    const char *close = strrchr(c, ')');
    return is_known && close && *space_skip(close + 1) == '\0' ? c + len : NULL;
}

/* Reads one number, all that stands before the last parenthesis.  @return false: it is none */
static bool number_read(const char *value, double *out)
{
    char *end;
    *out = strtod(value, &end);
    return end != value && space_skip(end) == strrchr(value, ')');
}

/* @return the performative of the answer */
static const char *line_take(struct broker *b, uint32_t own, const char *line, struct mu_text *t)
{
    double ms;
    const char *value = own == REGISTRY_BROKER || own == PART_DELIVERY ? value_of(line) : NULL;
    if (!value) {
        mu_text_format(t, "\"the broker carries out: (%s MS)\"", INTERVAL);
        return "failure";
    }
    if (!number_read(value, &ms) || !(ms >= 0 && ms <= DISPATCH_INTERVAL_MAX_MS)) {
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
    struct mu_text t = answer_begin(b, "");
    const char *performative = "refuse";
    if (strcmp(m->letter.performative, "do") == 0) {
        performative = line_take(b, own, m->letter.content, &t);
    } else {
        mu_text_format(&t, "%s %s", m->letter.performative,
                       mu_refusal_word(MU_REFUSAL_UNSUPPORTED));
    }
    answer_reply(b, own, m, performative);
}
