/* SPDX-License-Identifier: Apache-2.0 */
/* A comparison for terminals and for programs. */
#include "core/json.h"
#include "core/text.h"
#include "report/compare/compare.h"

#include <math.h>
#include <string.h>

/* What stands at the end of a name, and what it means. */
static const struct {
    const char *end, *unit;
} compare_units[] = {
    {"_m_s", "m/s"}, {"_rad", "rad"}, {"_m", "m"}, {"_s", "s"}, {"_fraction", "of 1"}};

void compare_label(char label[COMPARE_NAME_MAX + 16], const char *statistic)
{
    size_t len = strlen(statistic);
    const char *unit = NULL;
    struct mu_text t = mu_text_in(label, COMPARE_NAME_MAX + 16);
    for (size_t i = 0; !unit && i < sizeof compare_units / sizeof compare_units[0]; i++) {
        size_t end = strlen(compare_units[i].end);
        if (len > end && strcmp(statistic + len - end, compare_units[i].end) == 0) {
            unit = compare_units[i].unit;
            len -= end;
        }
    }
    for (size_t i = 0; i < len; i++) {
        bool first_dot = statistic[i] == '.' && !memchr(statistic, '.', i);
        mu_text_add(&t, first_dot ? ":" : "");
        mu_text_add_bytes(&t, strchr("_.", statistic[i]) ? " " : &statistic[i], 1);
    }
    if (unit) {
        mu_text_format(&t, " (%s)", unit);
    }
}

static void object_print(FILE *to, const struct compare *c, const struct compare_group *group,
                         unsigned statistic)
{
    const struct interval *i = &group->statistics[statistic];
    struct mu_json j = mu_json_line(to);
    mu_json_string(&j, "group", group->name);
    mu_json_string(&j, "statistic", c->statistics[statistic]);
    mu_json_uint(&j, "runs", i->count);
    mu_json_real(&j, "mean", i->mean);
    mu_json_real(&j, "half_width_95", interval_half_width(i));
    mu_json_real(&j, "deviation", interval_deviation(i));
    mu_json_real(&j, "least", i->least);
    mu_json_real(&j, "most", i->most);
    mu_json_end(&j);
}

/* Four digits that count, and no exponent where people look. */
static const char *number_show(char text[32], double value)
{
    int digits = value == 0 ? 0 : (int)floor(log10(fabs(value)));
    int decimals = digits >= 3 ? 0 : digits <= -3 ? 6 : 3 - digits;
    bool none = !isfinite(value);
    snprintf(text, 32, none ? "-" : "%.*f", value == 0 ? 0 : decimals, value);
    return text;
}

static void row_print(FILE *to, const struct compare *c, const struct compare_group *group,
                      const int widths[2], unsigned statistic)
{
    const struct interval *i = &group->statistics[statistic];
    char mean[32], half[32], deviation[32], least[32], most[32];
    fprintf(to, "%-*s  %-*s %5zu %10s %10s %10s %10s %10s\n", widths[0], c->statistics[statistic],
            widths[1], group->name, i->count, number_show(mean, i->mean),
            number_show(half, interval_half_width(i)),
            number_show(deviation, interval_deviation(i)), number_show(least, i->least),
            number_show(most, i->most));
}

static void table_print(const struct compare *c, FILE *to)
{
    int widths[2] = {sizeof "statistic" - 1, sizeof "group" - 1};
    for (unsigned k = 0; k < c->statistics_count; k++) {
        int len = (int)strlen(c->statistics[k]);
        widths[0] = compare_has(c, k) && len > widths[0] ? len : widths[0];
    }
    for (unsigned g = 0; g < c->groups_count; g++) {
        int len = (int)strlen(c->groups[g].name);
        widths[1] = len > widths[1] ? len : widths[1];
    }
    fprintf(to, "%-*s  %-*s %5s %10s %10s %10s %10s %10s\n", widths[0], "statistic", widths[1],
            "group", "runs", "mean", "+- 95 %", "deviation", "least", "most");
    for (unsigned k = 0; k < c->statistics_count; k++) {
        for (unsigned g = 0; g < c->groups_count; g++) {
            if (c->groups[g].statistics[k].count > 0) {
                row_print(to, c, &c->groups[g], widths, k);
            }
        }
    }
    for (unsigned g = 0; g < c->groups_count; g++) {
        fprintf(to, "%s: %u of %u runs as expected\n", c->groups[g].name, c->groups[g].as_expected,
                c->groups[g].runs);
    }
}

void compare_print(const struct compare *c, FILE *to, bool json)
{
    if (!json) {
        table_print(c, to);
        return;
    }
    for (unsigned k = 0; k < c->statistics_count; k++) {
        for (unsigned g = 0; g < c->groups_count; g++) {
            if (c->groups[g].statistics[k].count > 0) {
                object_print(to, c, &c->groups[g], k);
            }
        }
    }
}
