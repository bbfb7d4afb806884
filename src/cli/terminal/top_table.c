/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/terminal/terminal.h"

#include "core/json.h"
#include "core/sort.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* A number that is not there: shown as "-", in JSON as null. */
static const double NONE = (double)NAN;

/* A column of numbers has a value. */
struct column {
    const char *key, *head;
    int width, decimals; /* width < 0: to the left */
    double (*value)(const struct mu_stats_robot *r);
};

struct row {
    struct mu_stats_robot r; /* of an agent name, state and what it has of columns */
    bool body;
};

static double distance(const struct mu_stats_robot *r)
{
    return r->distance_m;
}

static double mean(const struct mu_stats_robot *r)
{
    return r->mean_speed_m_s;
}

static double efficiency(const struct mu_stats_robot *r)
{
    return r->efficiency_m_s;
}

static double speed(const struct mu_stats_robot *r)
{
    return r->speed_m_s;
}

static double stalls(const struct mu_stats_robot *r)
{
    return r->stalls;
}

static double stalled(const struct mu_stats_robot *r)
{
    return r->stalled_s;
}

static double explored(const struct mu_stats_robot *r)
{
    return r->explored < 0 ? NONE : r->explored * 100;
}

static double nearest(const struct mu_stats_robot *r)
{
    return r->nearest_m < 0 ? NONE : r->nearest_m;
}

static double sent(const struct mu_stats_robot *r)
{
    return (double)r->mails_sent;
}

static double received(const struct mu_stats_robot *r)
{
    return (double)r->mails_received;
}

static double fired(const struct mu_stats_robot *r)
{
    return (double)r->firings;
}

static double goal(const struct mu_stats_robot *r)
{
    return r->has_goal ? r->goal_s : NONE;
}

static double x(const struct mu_stats_robot *r)
{
    return r->x_m;
}

static double y(const struct mu_stats_robot *r)
{
    return r->y_m;
}

/* What matters most comes first: a narrow terminal has no room for the rest. */
static const struct column columns[] = {
    {"name", "NAME", -16, 0, NULL},
    {"state", "STATE", -9, 0, NULL},
    {"distance", "DIST m", 9, 2, distance},
    {"speed", "m/s", 6, 2, speed},
    {"stalls", "STALLS", 7, 0, stalls},
    {"stalled", "STALL s", 8, 1, stalled},
    {"explored", "EXPL %", 7, 1, explored},
    {"nearest", "NEAR m", 7, 2, nearest},
    {"sent", "SENT", 8, 0, sent},
    {"received", "RECV", 8, 0, received},
    {"fired", "FIRED", 9, 0, fired},
    {"mean", "MEAN", 6, 2, mean},
    {"efficiency", "EFF", 6, 2, efficiency},
    {"goal", "GOAL s", 8, 1, goal},
    {"x", "X m", 8, 2, x},
    {"y", "Y m", 8, 2, y},
};

enum { COLUMNS = sizeof columns / sizeof columns[0], NAME = 0, STATE = 1 };

int top_table_key(const char *key)
{
    for (int i = 0; i < COLUMNS; i++) {
        if (strcmp(columns[i].key, key) == 0) {
            return i;
        }
    }
    return -1;
}

const char *top_table_key_of(int column)
{
    return columns[(column % COLUMNS + COLUMNS) % COLUMNS].key;
}

void top_table_keys(struct mu_text *out)
{
    for (size_t i = 0; i < COLUMNS; i++) {
        mu_text_format(out, "%s%s", i ? ", " : "", columns[i].key);
    }
}

/* --- rows ------------------------------------------------------------------------------------- */

size_t top_table_rows(const mu_stats *s)
{
    return mu_stats_count(s) + mu_stats_agent_count(s);
}

static struct row row_of(const mu_stats *s, size_t index)
{
    size_t robots = mu_stats_count(s);
    struct row row = {.body = index < robots};
    if (row.body) {
        row.r = *mu_stats_robot(s, index);
        return row;
    }
    const struct mu_stats_agent *a = mu_stats_agent(s, index - robots);
    row.r = (struct mu_stats_robot){.state = a->state,
                                    .mails_sent = a->mails_sent,
                                    .mails_received = a->mails_received,
                                    .firings = a->firings};
    mu_text_copy(row.r.name, sizeof row.r.name, a->name);
    return row;
}

static bool is_of_agents(const struct column *c)
{
    return c->value == sent || c->value == received || c->value == fired;
}

static double value_of(const struct column *c, const struct row *row)
{
    return c->value && (row->body || is_of_agents(c)) ? c->value(&row->r) : NONE;
}

/* --- order ------------------------------------------------------------------------------------ */

struct sorting {
    const mu_stats *stats;
    int column;
};

static int words_compare(const struct sorting *s, const struct mu_stats_robot *a,
                         const struct mu_stats_robot *b)
{
    return s->column == NAME ? strcmp(a->name, b->name) : (int)a->state - (int)b->state;
}

/* What is not there comes last. */
static int numbers_compare(double a, double b, bool rises)
{
    if (isnan(a) || isnan(b)) {
        return !!isnan(a) - !!isnan(b);
    }
    return rises ? (a > b) - (a < b) : (a < b) - (a > b);
}

static int rows_compare(const void *one, const void *other, const void *context)
{
    const struct sorting *s = context;
    size_t i = *(const size_t *)one, j = *(const size_t *)other;
    const struct row a = row_of(s->stats, i), b = row_of(s->stats, j);
    const struct column *c = &columns[s->column];
    int order = c->value ? numbers_compare(value_of(c, &a), value_of(c, &b), c->value == nearest)
                         : words_compare(s, &a.r, &b.r);
    return order != 0 ? order : (i > j) - (i < j);
}

void top_table_sort(const mu_stats *s, int column, size_t *order)
{
    struct sorting sorting = {s, (column % COLUMNS + COLUMNS) % COLUMNS};
    size_t count = top_table_rows(s);
    for (size_t i = 0; i < count; i++) {
        order[i] = i;
    }
    mu_sort(order, count, sizeof *order, rows_compare, &sorting);
}

/* --- text ------------------------------------------------------------------------------------- */

static struct mu_text *line_begin(struct top_line *l)
{
    mu_text_init(&l->text, l->bytes, sizeof l->bytes);
    return &l->text;
}

static size_t width_of(const struct column *c)
{
    return (size_t)(c->width < 0 ? -c->width : c->width) + 1;
}

size_t top_table_columns(size_t wide)
{
    size_t count = 1, used = width_of(&columns[0]);
    while (count < COLUMNS && (wide == 0 || used + width_of(&columns[count]) <= wide)) {
        used += width_of(&columns[count++]);
    }
    return count;
}

void top_table_head(struct top_line *l, size_t count, int sorted)
{
    struct mu_text *t = line_begin(l);
    for (size_t i = 0; i < count && i < COLUMNS; i++) {
        char head[16];
        snprintf(head, sizeof head, "%s%s", columns[i].head, (int)i == sorted ? "*" : "");
        mu_text_format(t, "%s%*s", i ? " " : "", columns[i].width, head);
    }
}

static void cell_add(struct mu_text *t, const struct column *c, const struct row *row)
{
    char shown[MU_TEXT_SHOWN];
    const struct mu_stats_robot *r = &row->r;
    double value = value_of(c, row);
    if (c == &columns[NAME]) {
        mu_text_format(t, "%*.*s", c->width, -c->width, mu_text_show(shown, r->name));
    } else if (c == &columns[STATE]) {
        mu_text_format(t, "%*s", c->width, r->stalled ? "stalled" : mu_state_text(r->state));
    } else if (isnan(value)) {
        mu_text_format(t, "%*s", c->width, "-");
    } else if (c->value == goal && !r->there) {
        mu_text_format(t, ">%*.*f", c->width - 1, c->decimals, value); /* not there yet */
    } else {
        mu_text_format(t, "%*.*f", c->width, c->decimals, value);
    }
}

void top_table_row(struct top_line *l, const mu_stats *s, size_t index, size_t count)
{
    struct mu_text *t = line_begin(l);
    const struct row row = row_of(s, index);
    for (size_t i = 0; i < count && i < COLUMNS; i++) {
        mu_text_add(t, i ? " " : "");
        cell_add(t, &columns[i], &row);
    }
}

static void team_world(struct mu_text *t, const struct mu_stats_team *team, const mu_stats *s)
{
    char shown[MU_TEXT_SHOWN];
    double factor = team->wall_s > 0 ? team->time_s / team->wall_s : 0;
    mu_text_format(t, "%zu robots, ", mu_stats_count(s));
    if (mu_stats_agent_count(s) > 0) {
        mu_text_format(t, "%zu agents, ", mu_stats_agent_count(s));
    }
    mu_text_format(t, "step %" PRId64 ", %.1f s, %.1f x real time", team->step, team->time_s,
                   factor);
    if (team->missed > 0) {
        mu_text_format(t, ", %" PRIu64 " steps not seen", team->missed);
    }
    if (team->most_efficient) {
        mu_text_format(t, "; most efficient: %s, %.2f m/s",
                       mu_text_show(shown, team->most_efficient), team->efficiency_m_s);
    }
}

static void team_sums(struct mu_text *t, const struct mu_stats_team *team)
{
    mu_text_format(t, "together %.2f m, %" PRIu64 " stalls, %" PRIu64 " rules fired",
                   team->distance_m, team->stalls, team->firings);
    if (team->explored >= 0) {
        mu_text_format(t, ", %.1f %% of the floor", team->explored * 100);
    }
}

static void team_mail(struct mu_text *t, const mu_stats *s, const struct mu_stats_team *team)
{
    char shown[MU_TEXT_SHOWN];
    const char *word;
    uint64_t count;
    mu_text_format(t, "mail %" PRIu64 " sent, %" PRIu64 " received, %" PRIu64 " from outside",
                   team->mails_sent, team->mails_received, team->mails_outside);
    for (size_t i = 0; (word = mu_stats_performative(s, i, &count)); i++) {
        mu_text_format(t, "%s %s %" PRIu64, i ? "," : ":",
                       word[0] ? mu_text_show(shown, word) : "plain", count);
    }
}

void top_table_team(struct top_line *l, const mu_stats *s, size_t index)
{
    struct mu_text *t = line_begin(l);
    struct mu_stats_team team = mu_stats_team(s);
    if (index == 0) {
        team_world(t, &team, s);
    } else if (index == 1) {
        team_sums(t, &team);
    } else if (index == 2) {
        team_mail(t, s, &team);
    }
}

/* --- the end ---------------------------------------------------------------------------------- */

static const char *end_text(enum mu_run_end end)
{
    return end == MU_RUN_DONE ? "done" : end == MU_RUN_FAULT ? "fault" : "lost";
}

/* What others have written, cut to a length and made printable. */
static void shown_add(struct mu_text *t, const char *text)
{
    for (size_t i = 0; text[i] && i < 128; i++) {
        unsigned char c = (unsigned char)text[i];
        mu_text_add_bytes(t, c < ' ' || c > '~' ? "?" : text + i, 1);
    }
}

void top_table_end(struct top_line *l, const struct mu_run_result *result)
{
    struct mu_text *t = line_begin(l);
    mu_text_format(t, "%s at step %" PRId64 ", %.1f s", end_text(result->end), result->step,
                   (double)result->time_ns / 1e9);
    if (result->time_ns < result->duration_ns) {
        mu_text_format(t, " of %.1f s", (double)result->duration_ns / 1e9);
    }
    if (result->end == MU_RUN_DONE) {
        mu_text_add(t, ", hash ");
        shown_add(t, result->hash);
    } else {
        mu_text_add(t, ": ");
        shown_add(t, result->reason);
    }
}

/* --- JSON ------------------------------------------------------------------------------------- */

static void json_share(struct mu_json *j, const char *key, double value)
{
    mu_json_real(j, key, value < 0 ? NONE : value); /* null */
}

static void json_nearest(struct mu_json *j, const mu_stats *s, const struct mu_stats_robot *r)
{
    const struct mu_stats_robot *other = mu_stats_robot(s, r->nearest);
    bool known = r->nearest_m >= 0 && other;
    mu_json_real(j, "nearest_m", known ? r->nearest_m : NONE);
    mu_json_string(j, "nearest", known ? other->name : NULL);
    mu_json_real(j, "nearest_s", known ? r->nearest_s : NONE);
}

static void json_mails(struct mu_json *j, const struct mu_stats_robot *r)
{
    mu_json_uint(j, "mail_sent", r->mails_sent);
    mu_json_uint(j, "mail_received", r->mails_received);
    mu_json_uint(j, "rule_firings", r->firings);
}

static void json_counts(struct mu_json *j, const struct mu_stats_robot *r)
{
    mu_json_real(j, "distance_m", r->distance_m);
    mu_json_real(j, "mean_speed_m_s", r->mean_speed_m_s);
    mu_json_real(j, "efficiency_m_s", r->efficiency_m_s);
    mu_json_uint(j, "stalls", r->stalls);
    mu_json_real(j, "stalled_s", r->stalled_s);
    json_share(j, "explored_fraction", r->explored);
    mu_json_real(j, "goal_s", r->has_goal ? r->goal_s : NONE);
    mu_json_bool(j, "at_goal", r->there);
}

static void json_place(struct mu_json *j, const struct mu_stats_robot *r)
{
    mu_json_real(j, "x_m", r->x_m);
    mu_json_real(j, "y_m", r->y_m);
    mu_json_real(j, "heading_rad", r->heading_rad);
    mu_json_real(j, "speed_m_s", r->speed_m_s);
    mu_json_bool(j, "stalled", r->stalled);
}

void top_table_json(FILE *to, const mu_stats *s, size_t index)
{
    const struct row row = row_of(s, index);
    const struct mu_stats_robot *r = &row.r;
    struct mu_stats_team team = mu_stats_team(s);
    struct mu_json j = mu_json_line(to);
    mu_json_int(&j, "step", team.step);
    mu_json_real(&j, "time_s", team.time_s);
    mu_json_string(&j, "name", r->name);
    mu_json_string(&j, "kind", row.body ? "robot" : "agent");
    mu_json_string(&j, "state", mu_state_text(r->state));
    json_mails(&j, r);
    if (row.body) {
        json_place(&j, r);
        json_counts(&j, r);
        json_nearest(&j, s, r);
        mu_json_bool(&j, "most_efficient",
                     team.most_efficient && strcmp(team.most_efficient, r->name) == 0);
    }
    mu_json_end(&j);
}

static void json_mail(struct mu_json *j, const mu_stats *s)
{
    const char *word;
    uint64_t count;
    mu_json_object(j, "mail_by_performative");
    for (size_t i = 0; (word = mu_stats_performative(s, i, &count)); i++) {
        mu_json_uint(j, word, count);
    }
    mu_json_end(j);
}

void top_table_json_end(FILE *to, const mu_stats *s, const struct mu_run_result *result)
{
    struct mu_stats_team team = mu_stats_team(s);
    struct mu_json j = mu_json_line(to);
    mu_json_string(&j, "end", end_text(result->end));
    mu_json_int(&j, "step", result->step);
    mu_json_real(&j, "time_s", (double)result->time_ns / 1e9);
    mu_json_string(&j, "hash", result->hash);
    mu_json_string(&j, "reason", result->reason);
    json_share(&j, "explored_fraction", team.explored);
    mu_json_string(&j, "most_efficient", team.most_efficient);
    json_mail(&j, s);
    mu_json_uint(&j, "missed", team.missed);
    mu_json_end(&j);
}
